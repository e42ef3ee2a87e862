/// How far an image is from a reference: the measures of `covtrace compare`.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "image/brightness_deciles.h"
#include "image/image.h"

namespace covtrace {

/// Measures of an image I against a reference R: root channels R, G, B (or Y for all three),
/// linear. A pixel whose root colour is not finite in either image is left out of all measures but
/// `nonfinite` and `identical`; where no pixel is left, they are NaN.
struct Comparison {
    double mse = 0;     ///< mean over pixels and channels of (I - R)²
    double relmse = 0;  ///< mean over pixels and channels of (I - R)² / (R² + 0.01)
    /// The relmse without the floor(n / 1000) of the n pixels whose error, averaged over the
    /// channels, is largest.
    double relmse_trimmed = 0;
    /// The relmse_trimmed at the exposure at which the reference's median is 1, so that dark images
    /// count like bright ones: mean of (I - R)² / (R² + (m / 10)²), trimmed alike. m is the median
    /// luminance of R, the upper of two; where it is not above 0 the mean, and where that is not
    /// either, 1.
    double relmse_median = 0;
    double psnr =
        0;  ///< dB, of the sRGB-encoded images clamped to [0, 1]; +Inf where they are equal
    double flip = 0;  ///< mean LDR-FLIP of the images clamped to [0, 1], 67 pixels per degree
    std::array<double, 3> mean_ratio{};  ///< sum I / sum R of each channel; 0 / 0 is NaN
    /// Ratio sum I / sum R of the luminances in each decile of R's brightness (brightness_deciles),
    /// the darkest first; 0 / 0 is NaN, also in the deciles that fewer than ten blocks leave empty.
    std::array<double, kDeciles> decile_ratio{};
    int64_t nonfinite = 0;  ///< values that are not finite, all channels of the image
    int64_t pixels = 0;     ///< pixels that the measures are taken over
    PixelBounds bounds;     ///< the pixels that both images and the crop have
    /// FLIP error of every pixel in `bounds`, row by row; 0 where a pixel is left out.
    std::vector<float> flip_map;
    bool identical =
        false;  ///< same windows, channel names and bits; metadata and crop don't matter
};

/// Compares the pixels of `crop`, or all. Both images must have the same display window. Where
/// their data windows differ, the pixels that both have are compared, if a crop is given or one
/// window contains the other.
///
/// Throws Error(usage): different sizes (the message names both), data windows that don't fit, a
/// crop without common pixels, no root colour.
Comparison compare(const Image& image, const Image& reference,
                   std::optional<PixelBounds> crop = std::nullopt);

}  // namespace covtrace
