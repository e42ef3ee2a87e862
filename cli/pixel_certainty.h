/// Certainty of a pixel: its estimated error, what it would take to lower it, and why it is there.
#pragma once

#include <optional>
#include <string>

#include "image/image.h"

namespace covtrace::cli {

/// The estimated standard error over sqrt(luminance² + 0.01), as relMSE has it; empty without the
/// layer `error` or colours, 0 where it is not finite.
std::optional<double> relative_error(const Image& image, size_t index);

/// Square root of the mean of the squared relative errors, which `render --error` compares; empty
/// where no pixel has one.
std::optional<double> image_error(const Image& image);

struct PixelCertainty {
    double relative_error = 0;
    /// The factor of samples that would bring the pixel to the error of the whole image, with noise
    /// that falls with their root; 1 where it is as low already.
    double samples_factor = 1;
    std::string sentence;  ///< both in words, after the cause where the layers tell one
};

/// The certainty of the pixel with this index; empty without the layer `error`. `whole` is
/// `image_error`.
std::optional<PixelCertainty> pixel_certainty(const Image& image, size_t index, double whole);

}  // namespace covtrace::cli
