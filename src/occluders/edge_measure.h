/// How much an edge beside a segment matters at the segment's end.
#pragma once

#include <algorithm>

#include "core/vec.h"

namespace covtrace {

/// The width of the shadow, or of the edge in the image, that an occluder's edge makes at the end
/// of a segment. The edge passes the segment at the perpendicular distance r, at the distance z
/// from its end, both in scene units:
///
///     width^2 = ((a0 + a1 z)^2 + b r^2) / (h0 + h1 z + h2 z^2)
///
/// It is a standard deviation in the units of `widest`: scene units at a surface, slopes at a
/// perspective camera. The first term is the blur that the edge has where it arrives (penumbra,
/// circle of confusion), the second its distance. docs/decisions/0014 derives it;
/// measure_at_surface and measure_at_camera (frequency/occlusion.h) set the coefficients. Only
/// edges narrower than `widest` are wanted. h2 >= 0: searches take the larger value at the ends of
/// a range of z for the denominator's bound.
struct EdgeMeasure {
    float a0 = 0, a1 = 0;
    float b = 1;
    float h0 = 1, h1 = 0, h2 = 0;
    float widest = 0;  ///< the width itself, not its square

    float numerator(float z, float r2) const {
        const float a = a0 + a1 * z;
        return a * a + b * r2;
    }
    /// The denominator, which rounding never makes less than a millionth of h0.
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
