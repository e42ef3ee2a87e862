#include "light/equal_area.h"

#include <cmath>

#include "core/fast_math.h"

namespace covtrace {

namespace {
constexpr float kHalfRoot = 0.70710678118654752f;  // sine and cosine of pi / 4
}

Vec3 equal_area_square_to_sphere(Vec2 uv) {
    const float a = 2 * uv.x - 1, b = 2 * uv.y - 1;
    const float x = std::abs(a), y = std::abs(b);
    // The inner diamond of the square is the upper hemisphere, the rest is the lower one turned
    // outside in. r is the radius of a concentric diamond in either, 1 at the horizon.
    const float inside = 1 - (x + y);
    const float r = 1 - std::abs(inside);
    // The turn is the azimuth within the quadrant of (a, b), from 0 to pi / 2, less pi / 4.
    const SinCos turn = sin_cos_octant(r > 0 ? (y - x) / r * (kPi / 4) : -kPi / 4);
    const float z = std::copysign(1 - r * r, inside);
    const float s = r * std::sqrt(2 - r * r) * kHalfRoot;
    return {std::copysign(s * (turn.cos - turn.sin), a),
            std::copysign(s * (turn.cos + turn.sin), b), z};
}

Vec2 equal_area_sphere_to_square(Vec3 w) {
    const float x = std::abs(w.x), y = std::abs(w.y);
    // The radius is r = sqrt(1 - |z|), computed by the horizontal part: near the poles 1 - |z|
    // would cancel.
    const float horizontal = x * x + y * y;
    const float r = std::sqrt(horizontal / (1 + std::abs(w.z)));
    const float share = x + y > 0 ? arctangent(y, x) * (2 / kPi) : 0.0f;
    float v = share * r, u = r - v;
    // The lower hemisphere is turned outside in: its point is mirrored at the diagonal u + v = 1.
    if (w.z < 0) {
        const float t = u;
        u = 1 - v;
        v = 1 - t;
    }
    return {0.5f * (1 + std::copysign(u, w.x)), 0.5f * (1 + std::copysign(v, w.y))};
}

}  // namespace covtrace
