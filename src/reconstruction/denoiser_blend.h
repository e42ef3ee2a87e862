/// The blend of our own mixture and the denoiser's image.
#pragma once

#include "reconstruction/denoised.h"
#include "reconstruction/likeness.h"

namespace covtrace {

/// Data by which the denoiser is judged against our own mixture.
struct BlendInput {
    const std::array<ColorPlanes, 2>& samples;   ///< samples of A and B, with all their light
    const std::array<ColorPlanes, 2>& variance;  ///< variances of A and B
    const std::array<ColorPlanes, 2>& own;       ///< our own mixture of each half
    const ColorPlanes& lost;  ///< light that was cut off before our own filters saw the samples
    const ColorPlanes& g;     ///< weights of error_weights, for the brightness of prior_blend
};

/// The blend where samples tell nothing. Errors are measured against its brightness: a few pixels
/// that all missed the light are dark in our own mixture, and against that darkness their samples,
/// which missed it, too, would count many times as much as all around.
ColorPlanes prior_blend(const ColorPlanes& own, const Denoised& denoised);

/// The share a of our own mixture O in every pixel; the rest is the denoiser's image D. The share
/// minimises around each pixel, over the pixels that are alike,
///     sum g [ (D_A + a (O_A - D_A) - B)^2 + (D_B + a (O_B - D_B) - A)^2 ] / 2
///         + 2 r v (n / m) (a - p)^2 + l a^2,
/// v = sum g (V_A + V_B) / 2 the noise of the halves that judge, l = c sum g lost^2. The second
/// term is the prior: where the two images differ by less than the noise of the judging samples can
/// tell, as everywhere with few samples, our own image has the share p. With many samples the first
/// term decides. n / m is the number of pixels around over that of the pixels that are alike: the
/// fewer pixels judge, the less they tell, and the prior counts as if all of them were alike
/// (docs/decisions/0130). The third term is for rare light: light that was cut off as outliers is
/// missing in our own mixture, and the few samples that could tell so are too noisy to. Where they
/// are noisier still the prior outweighs it, so that p itself sinks with what was cut off:
///     p = p_0 / (1 + l / m)
/// (docs/decisions/0131). The constants r, p_0 and c are those of docs/decisions/0085.
Plane own_share(const BlendInput& input, const Denoised& denoised, const Likeness& likeness);

}  // namespace covtrace
