/// What the reconstruction sees of the film: two independent halves of the samples, as planes.
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

/// Low-discrepancy samples vary less in the mean than their own spread says. Scales the variances
/// of the colours by what the difference of the halves shows: box13((A - B)^2 / 2) over
/// box13((var A + var B) / 2), clamped to [0.1, 1], and then smooths them over 3x3 pixels
/// (Rousselle, Knaus and Zwicker 2012, section 4).
void rescale_variance(Halves& halves);

}  // namespace covtrace
