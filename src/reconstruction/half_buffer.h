/// The film as the reconstruction sees it: two halves of the samples, as planes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/plane.h"

namespace covtrace {

/// Planes of red, green and blue.
using ColorPlanes = std::array<Plane, 3>;

/// Number of features: albedo r g b, normal x y z, logarithm of the depth (its steps do not depend
/// on how far things are).
constexpr size_t kFeatures = 7;
using FeaturePlanes = std::array<Plane, kFeatures>;

/// One half of the samples: means per pixel and the variances of these means.
struct HalfBuffer {
    HalfBuffer(int w, int h);
    ColorPlanes color, color_variance;
    FeaturePlanes feature, feature_variance;
    Plane count;  ///< samples; a pixel with 0 has no colour and takes part in nothing
};

using Halves = std::array<HalfBuffer, 2>;

/// Whether no pixel has samples.
bool is_empty(const HalfBuffer& half);

/// Gives every pixel without samples the mean of the pixels around it, colours and features alike;
/// its count stays 0.
void fill_holes(HalfBuffer& half);

/// Gives a half without any samples the pixels of the other one: an empty half, as a render that
/// was interrupted at its start leaves it, is not black. Its count stays 0.
void replace_empty_half(Halves& halves);

/// Weights of the two halves of a pixel in a mean.
enum class CountBy : uint8_t {
    halves,   ///< equally: the samples of one half have planned how many the other one has
    samples,  ///< as many samples as they have: right where no samples have been planned by others
};

/// The mean colour of both halves; where one half has no samples, what the other has.
ColorPlanes mean_color(const Halves& halves, CountBy by = CountBy::halves);

/// The mean of both halves' three features from `first` on; where one half has no samples, what the
/// other has.
std::array<Plane, 3> mean_features(const Halves& halves, size_t first, CountBy by);

/// Sets the variances of both halves to those that their difference suggests, box13((A - B)^2) / 2;
/// of the features over 7 x 7 pixels. To be used where no pixel has two samples, so that their
/// spread is unknown. Holes are to be filled before; pixels that neither half has seen say nothing.
void set_variance_from_difference(Halves& halves);

}  // namespace covtrace
