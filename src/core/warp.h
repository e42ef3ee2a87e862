/// Maps from the unit square to the domains that a renderer samples, with their densities.
#pragma once

#include <cmath>

#include "core/fast_math.h"
#include "core/vec.h"

namespace covtrace {

/// Maps to the unit disc, concentrically (Shirley and Chiu 1997, "A low distortion map between disk
/// and square"); density 1/pi per area.
inline Vec2 square_to_disc(Vec2 u) {
    const float a = 2 * u.x - 1, b = 2 * u.y - 1;
    if (a == 0 && b == 0) return {};
    const bool wide = std::abs(a) > std::abs(b);
    const float r = wide ? a : b;
    const SinCos s = sin_cos_octant((kPi / 4) * (wide ? b / a : a / b));
    return wide ? Vec2{r * s.cos, r * s.sin} : Vec2{r * s.sin, r * s.cos};
}

/// Maps to the upper hemisphere about z with density cos(theta)/pi per solid angle.
inline Vec3 square_to_cosine_hemisphere(Vec2 u) {
    const Vec2 d = square_to_disc(u);
    return {d.x, d.y, safe_sqrt(1 - d.x * d.x - d.y * d.y)};
}
constexpr float cosine_hemisphere_pdf(float cos_theta) {
    return cos_theta > 0 ? cos_theta * kInvPi : 0;
}

/// Maps to the whole sphere, density 1/(4 pi) per solid angle.
inline Vec3 square_to_sphere(Vec2 u) {
    const float z = 1 - 2 * u.x, r = safe_sqrt(1 - z * z);
    const SinCos phi = sin_cos(2 * kPi * u.y);
    return {r * phi.cos, r * phi.sin, z};
}
inline constexpr float kUniformSpherePdf = kInvPi / 4;

/// Maps to the directions within a cone about z; density 1/(2 pi one_minus_cos_max) per solid
/// angle. The argument is 1 - cos of the half angle because that keeps tiny cones exact.
inline Vec3 square_to_cone(Vec2 u, float one_minus_cos_max) {
    const float h = u.x * one_minus_cos_max;  // 1 - cos(theta)
    const float sin_theta = safe_sqrt(h * (2 - h));
    const SinCos phi = sin_cos(2 * kPi * u.y);
    return {sin_theta * phi.cos, sin_theta * phi.sin, 1 - h};
}
constexpr float cone_pdf(float one_minus_cos_max) {
    return 1 / (2 * kPi * one_minus_cos_max);
}

/// Maps to barycentric coordinates (b0, b1) of a triangle, uniform by area (Heitz 2019, "A
/// low-distortion map between triangle and square").
inline Vec2 square_to_triangle(Vec2 u) {
    float b0 = u.x * 0.5f, b1 = u.y * 0.5f;
    const float offset = b1 - b0;
    if (offset > 0)
        b1 += offset;
    else
        b0 -= offset;
    return {b0, b1};
}

}  // namespace covtrace
