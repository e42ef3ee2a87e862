/// Removes the noise of lens and shutter from the features before they explain colours.
#pragma once

#include "reconstruction/half_buffer.h"

namespace covtrace {

/// Non-local means of the features of each half, weighted by the patches of the other half, and the
/// mean of both (Bitterli et al. 2016, section 4.2). Albedo, normal and depth are filtered apart.
FeaturePlanes filter_features(const Halves& halves);

}  // namespace covtrace
