/// The reconstruction of `hybrid` for images that other renderers have made.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "foreign/layer_search.h"
#include "image/image.h"
#include "reconstruction/denoiser.h"

namespace covtrace {

/// An image and the name that errors call it by.
struct NamedImage {
    std::string name;
    Image image;
};

struct DenoiseOptions {
    LayerNaming layers;
    std::optional<float> samples;  ///< samples per pixel of each image; empty: as the images say
    const Denoiser* denoiser = nullptr;  ///< one more candidate; null: none
    DenoiserQuality quality = DenoiserQuality::high;
};

struct DenoisedImage {
    /// R, G, B (A where all images have it), raw, variance (of raw), error (the standard error of
    /// the luminance), as renders have them; all finite.
    Image image;
    /// Root of the mean over the pixels of the luminance's estimated squared error over I^2 + 0.01,
    /// I the luminance; at the brightness at which it was reconstructed.
    double error = 0;
    /// Shortcomings of the images that cost quality, to be told as warnings.
    Warnings warnings;
};

/// Reconstructs one picture from two renders of it with noise of their own, or from one whose
/// variance is known (ImageHalves). There is no prediction: the candidates are the raw pixels,
/// regressions in plain windows, and the denoiser's. Images whose brightness is far from that of
/// displays are brought there meanwhile (core/display_exposure.h): the units do not matter.
///
/// Throws Error(usage), which names the image: layers that are missing, sizes that differ, two
/// images with the same pixels, no pixel that is finite, one image without variance, no image or
/// more than two.
DenoisedImage denoise(std::span<const NamedImage> images, const DenoiseOptions& options = {});

}  // namespace covtrace
