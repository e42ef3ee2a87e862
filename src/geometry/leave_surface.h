/// Points beside a surface, which rays from or to it start from or end at.
#pragma once

#include <bit>
#include <cmath>
#include <limits>

#include "geometry/hit.h"
#include "geometry/rounding.h"

namespace covtrace {

/// The next float above or below a finite one: std::nextafter without the call.
inline float next_float(float v, bool above) {
    if (v == 0)
        return above ? std::numeric_limits<float>::denorm_min()
                     : -std::numeric_limits<float>::denorm_min();
    const auto bits = std::bit_cast<uint32_t>(v);
    return std::bit_cast<float>((v > 0) == above ? bits + 1 : bits - 1);
}

/// The first float above or below a number.
inline float float_beyond(double v, bool above) {
    const auto nearest = static_cast<float>(v);
    const bool is_beyond = above ? nearest > v : nearest < v;
    return is_beyond ? nearest : next_float(nearest, above);
}

/// A point of a surface, moved off it to the side of `direction`: it is no farther than `error`
/// from the true surface, whose unit normal is `normal`, or 0 for points without a surface. The
/// coordinates are rounded away from the surface, so that they add less than one step each.
inline Vec3 off_surface(Vec3d position, Vec3 normal, double error, Vec3 direction) {
    const Vec3 n = dot(direction, normal) < 0 ? -normal : normal;
    const Vec3d by_error = position + Vec3d(n) * error;
    const auto rounded = [](double v, float away) {
        return away == 0 ? static_cast<float>(v) : float_beyond(v, away > 0);
    };
    return {rounded(by_error.x, n.x), rounded(by_error.y, n.y), rounded(by_error.z, n.z)};
}

/// The point of a hit where rays that look for something before it end, coming from `from`.
inline Vec3 end_before(const SurfaceHit& hit, Vec3 from) {
    const double error =
        double(hit.position_error) + meeting_error(0, double(distance(from, hit.position)));
    return off_surface(Vec3d(hit.position), hit.ng, error, from - hit.position);
}

/// A ray's end, to keep while it starts again and again.
inline Vec3 end_of(const Ray& ray) {
    return ray.origin + ray.direction * ray.t_max;
}

/// Lets a ray go on behind a hit, to where it was to end. Returns how far it has advanced. Far from
/// the scene's origin it starts a good deal beside the hit: its way is then another one by so much.
inline float go_on_behind(const SurfaceHit& hit, Vec3 end, Ray& ray) {
    const Vec3 behind =
        off_surface(Vec3d(hit.position), hit.ng, double(hit.position_error), ray.direction);
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
