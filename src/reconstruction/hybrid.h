/// The reconstruction of `--method hybrid`: several candidates, mixed by their measured errors.
#pragma once

#include <span>

#include "reconstruction/filter_field.h"
#include "reconstruction/half_buffer.h"

namespace covtrace {

struct HybridSettings {
    std::vector<float> gaussians{0.5f, 1.0f};
    struct Fit {
        float k;
        bool shaped;
        bool features;
    };
    std::vector<Fit> fits{{0.5f, false, true}, {1.0f, false, true}, {1.0f, true, true}};
    float sigma = 3;
    bool mix = true;
    bool outliers = true;
    bool rescale = true;
};

struct HybridImage {
    ColorPlanes color;
    Plane error;  ///< estimated variance of the luminance
    std::vector<Plane> share;
};

/// `halves`: variances as the samples say, to be rescaled here; `spectrum`: the predicted ones,
/// (cycles/pixel)^2, one per pixel.
HybridImage reconstruct(Halves halves, std::span<const covariance::Sym2<float>> spectrum,
                        const HybridSettings& settings = {});

}  // namespace covtrace
