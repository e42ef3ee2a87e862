/// The results of a denoiser for the samples of a film.
#pragma once

#include <optional>
#include <string>

#include "reconstruction/denoiser.h"
#include "reconstruction/half_buffer.h"

namespace covtrace {

/// Results of a denoiser for each half, and for all samples together.
struct Denoised {
    /// Results for the halves; of fast quality with the whole as their mean, and of few samples,
    /// where they judge nothing, the whole itself.
    std::array<ColorPlanes, 2> half;
    /// The result for all samples; of high quality the mean of those for both sights, upright and
    /// turned.
    ColorPlanes whole;
    /// Difference of the results for the two sights; of fast quality none.
    std::optional<ColorPlanes> difference;
};

/// Denoises both halves, to judge by, and all samples; of high quality and few samples those
/// alone. `few` tells how few samples they have, as LightReturn has it. Returns nothing without a
/// denoiser, or where it fails, and then `failure` says why.
std::optional<Denoised> denoised(const Denoiser* denoiser, DenoiserQuality quality,
                                 const Halves& halves, float few, std::string& failure);

}  // namespace covtrace
