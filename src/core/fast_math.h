/// Sine, cosine and arc tangent in a few multiplications, without calls and branches, so that they
/// vectorise and inline. The polynomials are minimax fits of our own (Remez exchange, relative
/// error 4e-9, 1e-10 and 1.9e-8); what is left is the rounding of float, checked in
/// tests/unit/core_fast_math_test.cpp.
#pragma once

#include <cmath>

#include "core/vec.h"

namespace covtrace {

struct SinCos {
    float sin, cos;
};

/// Sine and cosine for |x| <= pi / 4; within 1e-7.
constexpr SinCos sin_cos_octant(float x) {
    const float z = x * x;
    const float s = -0.16666654943f + z * (0.00833217814f - z * 0.00019517299f);
    const float c = 0.04166664687f + z * (-0.00138873675f + z * 2.443845159e-5f);
    return {x + x * z * s, 1 - 0.5f * z + z * z * c};
}

/// Sine and cosine for |x| up to some turns; within 2e-7.
inline SinCos sin_cos(float x) {
    // Take off the nearest multiple of pi / 2, in two parts of which the first is exact.
    const float quarter = std::floor(x * (2 / kPi) + 0.5f);
    const float rest = (x - quarter * 1.5703125f) - quarter * 4.83826794897e-4f;
    const SinCos r = sin_cos_octant(rest);
    const int q = static_cast<int>(quarter);
    const float sine = q & 1 ? r.cos : r.sin, cosine = q & 1 ? r.sin : r.cos;
    return {q & 2 ? -sine : sine, (q + 1) & 2 ? -cosine : cosine};
}

/// The angle of (x, y) from +x, in (-pi, pi], as std::atan2 but for signed zeros; 0 at the origin.
/// Relative error 3e-7.
inline float arctangent(float y, float x) {
    const float ax = std::abs(x), ay = std::abs(y);
    const float larger = std::max(ax, ay), smaller = std::min(ax, ay);
    const float t = larger > 0 ? smaller / larger : 0.0f, z = t * t;
    float p = -0.01658118519f + z * 0.00297459065f;
    p = 0.04355354171f + z * p;
    p = -0.07580578363f + z * p;
    p = 0.10678940406f + z * p;
    p = -0.14214209169f + z * p;
    p = 0.19994137210f + z * p;
    p = -0.33333166966f + z * p;
    float angle = t + t * z * p;
    angle = ay > ax ? kPi / 2 - angle : angle;
    angle = x < 0 ? kPi - angle : angle;
    return std::copysign(angle, y);
}

}  // namespace covtrace
