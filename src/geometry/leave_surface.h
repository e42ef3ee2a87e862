/// Points beside a surface, which rays from or to it start from or end at.
#pragma once

#include <bit>
#include <cmath>
#include <limits>

#include "geometry/hit.h"

namespace covtrace {

/// The next float above or below a finite one: std::nextafter without the call.
inline float next_float(float v, bool above) {
    if (v == 0)
        return above ? std::numeric_limits<float>::denorm_min()
                     : -std::numeric_limits<float>::denorm_min();
    const auto bits = std::bit_cast<uint32_t>(v);
    return std::bit_cast<float>((v > 0) == above ? bits + 1 : bits - 1);
}

/// A point of a surface, moved off it to the side of `direction`: it is no farther than `error`
/// from the true surface, whose unit normal is `normal`, or 0 for points without a surface.
inline Vec3 off_surface(Vec3 position, Vec3 normal, float error, Vec3 direction) {
    const Vec3 n = dot(direction, normal) < 0 ? -normal : normal;
    Vec3 moved;
    for (int i = 0; i < 3; ++i) {
        const float by_error = position[i] + n[i] * error;
        moved[i] = n[i] == 0 ? by_error : next_float(by_error, n[i] > 0);
    }
    return moved;
}

/// A ray's end, to keep while it starts again and again.
inline Vec3 end_of(const Ray& ray) {
    return ray.origin + ray.direction * ray.t_max;
}

/// Lets a ray go on behind a hit, to where it was to end. Returns how far it has advanced. Far from
/// the scene's origin it starts a good deal beside the hit: its way is then another one by so much.
inline float go_on_behind(const SurfaceHit& hit, Vec3 end, Ray& ray) {
    const Vec3 behind = off_surface(hit.position, hit.ng, hit.position_error, ray.direction);
    const float advanced = dot(behind - ray.origin, ray.direction);
    ray.origin = behind;
    if (!std::isfinite(ray.t_max)) return advanced;
    const Vec3 way = end - behind;
    const bool is_over = !(dot(way, ray.direction) > 0);
    ray.t_max = is_over ? 0 : length(way);
    if (!is_over) ray.direction = way / ray.t_max;
    return advanced;
}

}  // namespace covtrace
