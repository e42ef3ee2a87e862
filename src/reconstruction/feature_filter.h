/// Removes the noise of lens and shutter from the features before they explain colours.
#pragma once

#include "reconstruction/half_buffer.h"

namespace covtrace {

/// Filters the features by non-local means, those of each half weighted by the patches of the other
/// half (Bitterli et al. 2016, section 4.2, but not the mean of both: noise that is left in a
/// half's features would reach the fits of the other one, which then agree where both are wrong).
/// Albedo, normal and depth are filtered apart.
std::array<FeaturePlanes, 2> filter_features(const Halves& halves);

}  // namespace covtrace
