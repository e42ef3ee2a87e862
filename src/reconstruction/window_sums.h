/// Sums over pixels that are alike, in windows as wide as wanted at the cost of narrow ones.
#pragma once

#include <span>
#include <vector>

#include "reconstruction/likeness.h"

namespace covtrace {

/// Sums around every pixel, plane by plane.
struct WindowSums {
    std::vector<Plane> linear;   ///< sum w x of each plane x
    std::vector<Plane> squares;  ///< sum w^2 x of each plane x
};

/// Sums `linear` and `squares` over the pixels that are some multiple of `stride` away in x and in
/// y, weighed by how alike they are by `guides` (Likeness; nothing counts that is unlike). G is
/// `stride` times as wide as the Gaussian of `settings`. With sums of a smaller stride as input the
/// windows have no gaps ("à trous"; Dammertz et al., "Edge-avoiding à-trous wavelet transform for
/// fast global illumination filtering", 2010). All planes have one size.
WindowSums window_sums(std::span<const Plane> guides, std::span<const Plane> linear,
                       std::span<const Plane> squares, int stride,
                       const LikenessSettings& settings);

}  // namespace covtrace
