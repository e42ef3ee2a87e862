/// How much an edge beside a ray matters at the ray's end.
#pragma once

#include <algorithm>

#include "core/vec.h"

namespace covtrace {

/// The width, at the end of a segment, of the shadow edge (or of the image edge) that an occluder
/// gives which passes the segment at the perpendicular distance r, z before its end:
///
///     width^2 = ((a0 + a1 z)^2 + b r^2) / (h0 + h1 z + h2 z^2)
///
/// as a standard deviation, in the units of `widest`. The first term is the blur that the edge has
/// where it arrives (penumbra, circle of confusion), the second its distance. Only edges narrower
/// than `widest` are wanted. The denominator must not be concave.
struct EdgeMeasure {
    float a0 = 0, a1 = 0;
    float b = 1;
    float h0 = 1, h1 = 0, h2 = 0;
    float widest = 0;  ///< the width itself, not its square

    float numerator(float z, float r2) const {
        const float a = a0 + a1 * z;
        return a * a + b * r2;
    }
    float denominator(float z) const { return std::max(h0 + z * (h1 + z * h2), 1e-6f * h0); }
    float width_squared(float z, float r2) const { return numerator(z, r2) / denominator(z); }

    /// Part of [0, length] outside of which every edge is wider than `widest`; empty (lo > hi)
    /// where all edges are.
    struct Range {
        float lo = 0, hi = 0;
    };
    Range reach(float length) const;
};

}  // namespace covtrace
