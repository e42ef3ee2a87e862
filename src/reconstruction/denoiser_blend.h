/// How much of the image is the denoiser's.
#pragma once

#include "reconstruction/half_buffer.h"
#include "reconstruction/likeness.h"

namespace covtrace {

/// What a denoiser made of each half, and of all samples.
struct Denoised {
    std::array<ColorPlanes, 2> half;
    ColorPlanes whole;       ///< the mean of what it makes of both sights, upright and turned
    ColorPlanes difference;  ///< of the two sights
};

/// What judges the denoiser against our own mixture.
struct BlendInput {
    const std::array<ColorPlanes, 2>& samples;   ///< A and B, with all their light
    const std::array<ColorPlanes, 2>& variance;  ///< of A and B
    const std::array<ColorPlanes, 2>& own;       ///< our own mixture of each half
    const ColorPlanes& lost;  ///< what was cut off before our own filters saw the samples
    const ColorPlanes& g;     ///< of error_weights
};

/// The share a of our own mixture O in every pixel, the rest is the denoiser's D: what minimises
/// around each pixel, over the pixels that are alike,
///     sum g [ (D_A + a (O_A - D_A) - B)^2 + (D_B + a (O_B - D_B) - A)^2 ] / 2
///         + 2 r v (a - p)^2 + l a^2,
/// v = sum g (V_A + V_B) / 2 the noise of the halves that judge, l = c sum g lost^2. The second
/// term is the prior: where the two images differ by less than what the noise of the judging
/// samples can tell, as everywhere with few samples, our own one has the share p. With many samples
/// the first term decides. The third one is for rare light: what was cut off as outliers is missing
/// in our own mixture, and the few samples that could tell so are too noisy to. r, p and c:
/// docs/decisions/0085.
Plane own_share(const BlendInput& input, const Denoised& denoised, const Likeness& likeness);

}  // namespace covtrace
