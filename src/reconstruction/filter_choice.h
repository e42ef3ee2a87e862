/// The choice among filters of different width by what the samples say of their errors.
#pragma once

#include <span>
#include <vector>

#include "core/plane.h"
#include "reconstruction/filtered_image.h"
#include "reconstruction/unfiltered_share.h"

namespace covtrace {

/// Shares of the candidates in each pixel, 1 together. Most is given to the candidate whose
/// estimated squared error is least: (F - y)^2 - (1 - 2 a) r, y the raw pixel, r its variance and a
/// the weight of the pixel in its filtered value F [Stein 1981], as means over a Gaussian of a
/// pixel, each relative to the square of `brightness`, a luminance by pixel with little noise of
/// its own: relative to a noisy image dark pixels would decide, which rare bright paths have
/// missed. Others get exp(-d / (0.05 r)) of that, d the difference of the errors and r the mean
/// variance: estimates over so few pixels cannot tell smaller differences. The first candidate is
/// the cautious one: it is taken where nothing is known, and where others contradict pixels around
/// by far more than noise can. Seams are smoothed by a pixel.
std::vector<Plane> choose_filters(const RawLuminance& raw,
                                  std::span<const FilteredImage> candidates,
                                  const Plane& brightness);

/// The mixture of candidates by their shares; its noise as if theirs were one.
FilteredImage mixed(std::span<const FilteredImage> candidates, std::span<const Plane> shares);

}  // namespace covtrace
