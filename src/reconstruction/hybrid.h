/// The reconstruction of `--method hybrid`: several candidates, mixed by their measured errors.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "reconstruction/candidates.h"
#include "reconstruction/denoiser.h"
#include "reconstruction/error_estimate.h"
#include "reconstruction/half_buffer.h"
#include "reconstruction/likeness.h"

namespace covtrace {

struct HybridSettings {
    CandidateSettings candidates;
    ErrorFactors error, error_denoised = kDenoisedError;  ///< without and with a denoiser
    float sigma = 4;            ///< of the neighbourhood by which a first mixture is judged, pixels
    LikenessSettings likeness;  ///< of the pixels by which the final one is
    bool mix = true;            ///< false: the best single candidate, for comparisons
    const Denoiser* denoiser = nullptr;  ///< one more candidate; null: none
};

struct HybridImage {
    ColorPlanes color;
    /// Estimated squared error over I^2 + 0.01, mean of the three channels: its mean over the image
    /// estimates the relMSE.
    Plane relative_error;
    Plane variance;            ///< estimated absolute squared error of the luminance
    std::vector<Plane> share;  ///< of each candidate: raw, Gaussians, fits, the denoiser's
    /// Why the denoiser's candidate is missing; empty where it is not, or where there is none.
    std::string denoiser_failure;
};

/// `halves`: with the variances that their samples have; `spectrum`: the predicted ones after the
/// integral over lens and shutter, (cycles/pixel)^2, one per pixel. The result depends on nothing
/// else, and on no number of threads. With many samples it becomes the mean of the halves, wherever
/// the candidates are off by more than the noise of the raw pixels.
HybridImage reconstruct(Halves halves, std::span<const covariance::Sym2<float>> spectrum,
                        const HybridSettings& settings = {});

}  // namespace covtrace
