/// The reconstruction of `--method hybrid`: several candidates, mixed by their measured errors.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "reconstruction/candidates.h"
#include "reconstruction/denoiser.h"
#include "reconstruction/error_estimate.h"
#include "reconstruction/half_buffer.h"
#include "reconstruction/light_return.h"
#include "reconstruction/likeness.h"

namespace covtrace {

struct HybridSettings {
    CandidateSettings candidates;
    /// Factors without a denoiser, with one, with one of fast quality, and with one for few
    /// samples.
    ErrorFactors error, error_denoised = kDenoisedError, error_fast = kFastDenoisedError,
                        error_few = kFewDenoisedError;
    float sigma = 4;  ///< deviation of the neighbourhood that judges a first mixture, pixels
    LikenessSettings likeness;  ///< likeness of the pixels that judge the final mixture
    bool mix = true;            ///< false: the best single candidate, for comparisons
    HalvesNoise noise = HalvesNoise::of_one_sequence;
    const Denoiser* denoiser = nullptr;  ///< the denoiser that gives one more candidate; null: none
    DenoiserQuality quality = DenoiserQuality::high;
};

struct HybridImage {
    ColorPlanes color;
    /// Estimated squared error over I^2 + 0.01, mean of the three channels: its mean over the image
    /// estimates the relMSE.
    Plane relative_error;
    Plane variance;            ///< estimated absolute squared error of the luminance
    std::vector<Plane> share;  ///< shares of the candidates: raw, Gaussians, fits, the denoiser's
    /// Reason why the denoiser's candidate is missing; empty where it is there, or where none was
    /// asked for.
    std::string denoiser_failure;
};

/// Reconstructs the image. `halves` have the variances of their samples; `spectrum`: the predicted
/// spectra after the integral over lens and shutter, (cycles/pixel)^2, one per pixel; empty where
/// there is no prediction, and then no candidate that needs one. The result depends on nothing
/// else, and on no number of threads. With many samples it becomes the mean of the halves, wherever
/// the candidates are off by more than the noise of the raw pixels.
HybridImage reconstruct(Halves halves, std::span<const covariance::Sym2<float>> spectrum,
                        const HybridSettings& settings = {});

}  // namespace covtrace
