#include "light/spherical_triangle.h"

#include <cmath>

#include "core/fast_math.h"

namespace covtrace {

SphericalTriangle spherical_triangle(const WorldTriangle& triangle, Vec3 p) {
    SphericalTriangle t;
    const Vec3 a = triangle.p0 - p, b = triangle.p1 - p, c = triangle.p2 - p;
    const float la = length(a), lb = length(b), lc = length(c);
    if (!(la > 0 && lb > 0 && lc > 0)) return t;
    const float ia = 1 / la, ib = 1 / lb, ic = 1 / lc;
    t.v0 = a * ia;
    t.v1 = b * ib;
    t.v2 = c * ic;
    // The determinant v0 . (v1 x v2) is taken from the triangle's edges: unit vectors to the
    // corners of a small triangle are so alike that their cross product would be mostly rounding.
    const Vec3 normal = cross(triangle.p1 - triangle.p0, triangle.p2 - triangle.p0);
    t.volume = std::abs(dot(t.v0, normal)) * (ib * ic);
    t.g1 = dot(t.v0, t.v2) + dot(t.v1, t.v2);
    t.g2 = 1 + dot(t.v0, t.v1);
    // Solid angle by van Oosterom and Strackee 1983, "The solid angle of a plane triangle".
    t.solid_angle = 2 * arctangent(t.volume, t.g1 + t.g2);
    return t;
}

Vec3 sample_direction(const SphericalTriangle& t, Vec2 u) {
    // First a corner v2' on the arc from v0 to v2 that cuts off the share u.x of the solid angle.
    const float half = 0.5f * t.solid_angle * u.x;
    const auto [s, c] = sin_cos(half);
    const Vec3 r = t.v0 * (t.volume * c - t.g1 * s) + t.v2 * (t.g2 * s);
    const Vec3 corner = r * (2 * dot(t.v0, r) / dot(r, r)) - t.v0;
    // Then a point on the arc from v1 to v2', with the cosine of its angle to v1 uniform between 1
    // and s2: h is 1 - cosine, k the ratio of the sines of that angle and of the whole arc, k^2 = h
    // (2 - h) / (1 - s2^2). Both sides of the fraction have the factor 1 - s2, which is left out:
    // it has few digits for short arcs.
    const float s2 = dot(t.v1, corner);
    const float h = u.y * (1 - s2);
    const float k = s2 > -1 ? safe_sqrt(u.y * (2 - h) / (1 + s2)) : u.y;
    return normalize(t.v1 * (1 - h - k * s2) + corner * k);
}

}  // namespace covtrace
