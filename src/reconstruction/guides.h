/// What tells which pixels should be reconstructed alike.
#pragma once

#include "reconstruction/half_buffer.h"
#include "reconstruction/likeness.h"

namespace covtrace {

/// Feature `f` of both halves, its noise smoothed, in units in which pixels that differ by 1 are
/// not alike.
Plane feature_guide(const Halves& halves, size_t f);

/// The same of light: the logarithm of luminances.
Plane light_guide(const Plane& luminance);

/// Albedo, normal and depth.
void add_features(const Halves& halves, Likeness& likeness);

/// The logarithms of the light of `guess`, a first image, and of its pixels' noise relative to it.
void add_light_and_noise(const Halves& halves, const ColorPlanes& guess, Likeness& likeness);

}  // namespace covtrace
