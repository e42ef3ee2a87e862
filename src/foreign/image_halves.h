/// Images of other renderers as the halves that a reconstruction mixes and judges.
#pragma once

#include <optional>

#include "foreign/layer_search.h"
#include "reconstruction/half_buffer.h"

namespace covtrace {

/// An image with the layers that were found in it.
struct SampledImage {
    const Image& image;
    FoundLayers layers;
    std::optional<float> samples;  ///< samples per pixel; empty: those of its layer, or not known
    float exposure = 1;            ///< by which the halves' light is multiplied; a power of two
};

struct ImageHalves {
    Halves halves;
    /// Pixels without finite values in any image, or brighter than kBrightestShown
    /// (core/display_exposure.h) when exposed; in the halves they have no samples.
    int lost = 0;
    bool are_samples_known = false;  ///< whether the counts are those of the images
};

/// Makes halves of two renders of one picture with noise of their own. Variances are those of the
/// images where both have them, else those that the difference suggests. Pixels whose colour,
/// albedo or normal is not finite count as lost samples; what is negative in one image alone has no
/// samples either, and the other's colour. Both images have the same size and
/// exposure.
ImageHalves halves_of_two(const SampledImage& a, const SampledImage& b);

/// Makes halves of one image whose variance V is known: image + sqrt(V) z and image - sqrt(V) z, z
/// a random sign per pixel. Their mean is the image, their noise has twice its variance each, as
/// that of real halves, and they are uncorrelated (Oliveira, Lei, Tibshirani, "Unbiased Risk
/// Estimation in the Normal Means Problem via Coupled Bootstrap Techniques", 2021, whose z is
/// normal). With signs the squared difference of the halves is known exactly, and of a pixel that
/// one bright path made, whose V is its square, one half is twice as bright and the other dark, as
/// of real halves. Channels get the same z, since their noise is of the same paths. The result
/// depends on nothing but the image. `s` has a variance.
ImageHalves halves_of_one(const SampledImage& s);

}  // namespace covtrace
