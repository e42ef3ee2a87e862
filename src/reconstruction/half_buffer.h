/// What the reconstruction sees of the film: two halves of the samples, as planes.
#pragma once

#include <array>

#include "core/plane.h"

namespace covtrace {

/// Red, green, blue.
using ColorPlanes = std::array<Plane, 3>;

/// Albedo r g b, normal x y z, logarithm of the depth (its steps do not depend on how far things
/// are).
constexpr size_t kFeatures = 7;
using FeaturePlanes = std::array<Plane, kFeatures>;

/// Half of the samples: means per pixel and the variances of these means.
struct HalfBuffer {
    HalfBuffer(int w, int h);
    ColorPlanes color, color_variance;
    FeaturePlanes feature, feature_variance;
    Plane count;  ///< samples; a pixel with 0 has no colour and takes part in nothing
};

using Halves = std::array<HalfBuffer, 2>;

/// No pixel has samples.
bool is_empty(const HalfBuffer& half);

/// Gives every pixel without samples the mean of what is around it, colours and features alike; its
/// count stays 0.
void fill_holes(HalfBuffer& half);

/// Where no pixel has two samples their spread is unknown: sets the variances of both halves to
/// what the difference of the halves says, box13((A - B)^2) / 2; of the features over 7 x 7 pixels.
/// Holes are to be filled before; pixels that neither half has seen say nothing.
void set_variance_from_difference(Halves& halves);

}  // namespace covtrace
