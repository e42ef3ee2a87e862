/// The estimate of how far the delivered image is from the truth.
#pragma once

#include <span>

#include "reconstruction/selector.h"

namespace covtrace {

/// Factors of the terms of the estimate. The defaults fit the true errors of a set of scenes best:
/// error_fit (bench/sweeps, docs/decisions/0095) makes them, bench/quality/error_calibration
/// measures how well they do.
struct ErrorFactors {
    float noise = 1.31f, noise_of_few = 3.1f;
    float spread = 1.39f, returned = 0.37f, cut = 0.002f, sights = 0;
};

/// Factors for images with a denoiser's among the candidates.
constexpr ErrorFactors kDenoisedError{1.03f, 5, 0.56f, 0.63f, 0.001f, 2.05f};

/// Factors for images that are a denoiser's alone, of fast quality (docs/decisions/0147).
constexpr ErrorFactors kFastDenoisedError{0.95f, 9, 0, 0.63f, 0, 0};

/// Factors for images of few samples that are a denoiser's alone: what its two sights differ by
/// tells their error, and halves of a sample or two nothing (docs/decisions/0157).
constexpr ErrorFactors kFewDenoisedError{0, 0, 0, 0, 0, 32};

/// Estimated squared errors over I^2 + 0.01, I the brightness.
struct ErrorEstimate {
    Plane color;  ///< mean of the three channels, each over its own brightness
    /// Error of the luminance: less where the channels err in different directions.
    Plane luminance;
};

/// Estimates the error of `image`, the mean of the mixed halves with the light that was added to
/// keep that of the samples. `difference_of_sights` is the denoiser's, whose share is the last one;
/// null: none. `raw`: the mean of the halves before rare bright paths were limited; `brightness`:
/// I; `dark_squared`: 0.01, in the units of the image.
///
/// The halves' own measure of a pixel is no estimate: raw pixels are ten times as noisy as the
/// image, and the halves that judge have chosen shares and weights before (docs/decisions/0095).
/// The error is told from terms that are known with little noise, averaged over the pixels around
/// that are about as bright:
///     N = (M_A - M_B)^2 / 4, the noise that the mixtures M of the halves do not share,
///     S = (sum over c of share_c |m_c - m|)^2, how far the candidates c are from their mixture m,
///     E = (image - m)^2, the light of the neighbourhood that was added,
///     C = (raw - limited)^2, the light that was cut off: it is somewhere around only,
///     D = (share (upright - turned))^2 / 4, how far the denoiser's two sights are apart,
/// as (noise + noise_of_few / n) N + spread S + returned E + cut C + sights D, n the samples per
/// pixel. The part of N that grows with few samples stands for the noise that the halves share:
/// each takes its weights from the other one's noise.
ErrorEstimate estimate_error(const Halves& halves, std::span<const Candidate> candidates,
                             const Selection& selection, const ColorPlanes& image,
                             const ColorPlanes& raw, const ColorPlanes& brightness,
                             const ColorPlanes* difference_of_sights, const ErrorFactors& factors,
                             float dark_squared);

}  // namespace covtrace
