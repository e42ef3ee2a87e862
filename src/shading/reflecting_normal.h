/// The shading normal of surfaces that reflect light about the mirrored direction.
///
/// Normals of vertices and of maps stand for a surface that is not there. Seen at a grazing angle,
/// they mirror the view to below the surface that is: the light from there is lost, and coarse
/// meshes have dark bands. Such a normal is turned towards that of the geometry until the mirrored
/// direction is just above the surface (docs/decisions/0150).
///
/// With x along the part of the shading normal that is orthogonal to the geometric one, z, the
/// normal at the angle a to z is n = (sin a, 0, cos a), and the mirror image r = 2 (n.w) n - w of a
/// direction w has
///
///   r.z = w.x sin 2a + w.z cos 2a = p cos(2a - b),   p^2 = w.x^2 + w.z^2, tan b = w.x / w.z,
///
/// which falls to the least height h that is allowed at 2a = b + acos(h / p), once between a = 0,
/// where it is w.z, and a right angle.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/vec.h"

namespace covtrace {

/// The unit normal `n`, turned towards the geometric normal `ng`, in their plane, by as little as
/// lets the mirror image of `w` be above the surface: `n` itself where it is. `w`: unit direction
/// away from the surface, on either side; `n` and `ng`, unit, are on the same side as each other.
inline Vec3 reflecting_normal(Vec3 n, Vec3 ng, Vec3 w) {
    // Least cosine of the mirrored direction to the normal; at grazing angles a mirror of its own
    // reflects to less
    constexpr float kLeastCosine = 0.01f, kLeastShare = 0.9f;
    const float side = dot(w, ng) < 0 ? -1.0f : 1.0f;
    const float wz = side * dot(w, ng), least = std::min(kLeastCosine, kLeastShare * wz);
    const float nz = dot(n, ng);
    if (2 * dot(n, w) * side * nz - wz >= least) return n;
    const Vec3 across = n - ng * nz;
    const float size = length(across);
    if (!(size > 0)) return n;
    const Vec3 x = across / size;
    const float wx = side * dot(w, x), square = wx * wx + wz * wz;
    const float sine_of_p = std::sqrt(std::max(0.0f, square - least * least));
    // Double angle, times p^2; the bisector from z by the form that cancels less
    const float c = wz * least - wx * sine_of_p, s = wx * least + wz * sine_of_p;
    return normalize(c > 0 ? x * s + ng * (square + c) : x * (square - c) + ng * s);
}

}  // namespace covtrace
