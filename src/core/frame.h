/// Orthonormal frames: local directions have z along the frame's normal.
#pragma once

#include <cmath>

#include "core/vec.h"

namespace covtrace {

struct Frame {
    Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};

    /// Right-handed frame about the unit vector `n` (Duff et al. 2017, "Building an orthonormal
    /// basis, revisited").
    static Frame from_z(Vec3 n) {
        const float sign = std::copysign(1.0f, n.z);
        const float a = -1.0f / (sign + n.z);
        const float b = n.x * n.y * a;
        return {
            {1 + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
    }
    /// Right-handed frame about the unit vector `n` whose x axis is `tangent` made orthogonal to n;
    /// any x axis where the tangent is parallel to n or zero.
    static Frame from_z_x(Vec3 n, Vec3 tangent) {
        const Vec3 t = tangent - n * dot(n, tangent);
        const float l2 = length_squared(t);
        if (!(l2 > 1e-12f * length_squared(tangent))) return from_z(n);
        const Vec3 x = t / std::sqrt(l2);
        return {x, cross(n, x), n};
    }
    constexpr Vec3 to_local(Vec3 v) const { return {dot(v, x), dot(v, y), dot(v, z)}; }
    constexpr Vec3 to_world(Vec3 v) const { return x * v.x + y * v.y + z * v.z; }
};

}  // namespace covtrace
