/// Guides: planes that tell which pixels should be reconstructed alike.
#pragma once

#include "reconstruction/half_buffer.h"
#include "reconstruction/likeness.h"

namespace covtrace {

/// The guide by feature `f` of both halves, its noise smoothed, in units in which pixels that
/// differ by 1 are not alike.
Plane feature_guide(const Halves& halves, size_t f);

/// The guide by light: the logarithm of smoothed luminances, in such units, too.
Plane light_guide(const Plane& luminance);

/// Adds the guides by albedo, normal and depth.
void add_features(const Halves& halves, Likeness& likeness);

/// Adds the guides by the light of `guess`, a first image, and by its pixels' noise relative to it,
/// both as logarithms.
void add_light_and_noise(const Halves& halves, const ColorPlanes& guess, Likeness& likeness);

}  // namespace covtrace
