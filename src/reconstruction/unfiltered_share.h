/// The share of the unfiltered pixel in a gathered image: a filter is worth its bias only where
/// there is noise.
#pragma once

#include <span>

#include "core/plane.h"
#include "covariance/filter_field.hpp"

namespace covtrace {

/// One image before and after its filters: luminances and the variances of both, pixels in rows.
struct FilteredLuminance {
    Plane raw, raw_variance;
    Plane gathered, gathered_variance;
    /// The filters' covariances, pixels^2.
    std::span<const covariance::Sym2<float>> filter;
};

/// Parts of the raw pixels, from 0 to 1, in the mixture of raw and gathered pixels whose expected
/// squared error is least. The filter's squared bias is what the squared differences of both images
/// have beyond the variance of the difference, as means over a neighbourhood, each relative to the
/// squared luminance as errors are.
Plane unfiltered_share(const FilteredLuminance& image);

}  // namespace covtrace
