/// What tells which pixels should be reconstructed alike.
#pragma once

#include "reconstruction/half_buffer.h"
#include "reconstruction/likeness.h"

namespace covtrace {

/// Albedo, normal and depth.
void add_features(const Halves& halves, Likeness& likeness);

/// The logarithms of the light of `guess`, a first image, and of its pixels' noise relative to it.
void add_light_and_noise(const Halves& halves, const ColorPlanes& guess, Likeness& likeness);

}  // namespace covtrace
