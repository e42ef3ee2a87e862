/// The share of the unfiltered pixel in a gathered image: a filter is worth its bias only where
/// there is noise.
#pragma once

#include <span>
#include <vector>

#include "core/plane.h"

namespace covtrace {

/// The luminance of an image before its filters, and the variance of its pixels' means.
struct RawLuminance {
    Plane value, variance;
    std::vector<bool> known;  ///< whether a pixel has the two samples that tell a variance
};

/// Luminance and variance behind the filters.
struct FilteredLuminance {
    Plane value, variance;
    std::span<const float> own_weight;  ///< the part of the pixel's own mean in its filtered one
};

/// Parts of the raw pixels, from 0 to 1, in the mixture of raw and gathered pixels whose expected
/// squared error is least. The filter's squared bias is what the squared differences of both images
/// have beyond the variance of the difference, as means over a neighbourhood, each relative to the
/// squared luminance as errors are. 0 where no pixel around is known.
Plane unfiltered_share(const RawLuminance& raw, const FilteredLuminance& filtered);

}  // namespace covtrace
