/// The reconstruction of `--method hybrid`: several candidates, mixed by their measured errors.
#pragma once

#include <span>
#include <vector>

#include "reconstruction/filter_field.h"
#include "reconstruction/half_buffer.h"

namespace covtrace {

/// The candidates beside the raw pixels. docs/reconstruction.md has the table of what each gives.
struct HybridSettings {
    /// Scales of the predicted Gaussians; 1: the width factor c = 2.
    std::vector<float> gaussians{0.5f, 1.0f};
    /// First-order regressions: tolerance of the colours' patches, and whether the window also
    /// falls off as the predicted Gaussian, 2.5 times as wide.
    struct Fit {
        float k;
        bool shaped;
    };
    std::vector<Fit> fits{{0.5f, false}, {1.0f, false}, {2.0f, true}};
    float sigma = 3;  ///< of the neighbourhood over which candidates are judged, pixels
    bool mix = true;  ///< false: the best single candidate, for comparisons
};

struct HybridImage {
    ColorPlanes color;
    /// Estimated squared error over I^2 + 0.01, mean of the three channels: its mean over the image
    /// estimates the relMSE.
    Plane relative_error;
    Plane variance;            ///< the same as an absolute squared error of the luminance
    std::vector<Plane> share;  ///< of each candidate: raw, Gaussians, fits
};

/// `halves`: with the variances that their samples have; `spectrum`: the predicted ones after the
/// integral over lens and shutter, (cycles/pixel)^2, one per pixel. The result depends on nothing
/// else, and on no number of threads. With many samples it becomes the mean of the halves, wherever
/// the candidates are off by more than the noise of the raw pixels.
HybridImage reconstruct(Halves halves, std::span<const covariance::Sym2<float>> spectrum,
                        const HybridSettings& settings = {});

}  // namespace covtrace
