/// The share of the samples that plans of halves give out evenly.
#pragma once

#include <span>

#include "planner/adaptive.h"

namespace covtrace {

/// The least share, as light that the samples have not seen yet must not be starved
/// (docs/decisions/0093).
constexpr float kLeastEvenShare = 0.15f;

/// The share of all samples that both halves give out evenly, from kLeastEvenShare to 1. `halves`:
/// what the samples of each tell; `samples`: those per pixel so far, of both halves together.
///
/// Counts that follow the noise are best for filters whose error is in proportion to the variance
/// of the samples. Where a pixel is nearly all noise that is not so: rare bright paths are outliers
/// to every filter and denoiser, the more so the fewer samples there are, and dark places that the
/// plan gives few lose their light. So the share grows with how much of the image is noise,
///     kLeastEvenShare + (1 - kLeastEvenShare) s^3,   s = mean of r / (1 + r),
/// r the variance of a pixel's mean over I^2 + eps, both averaged over the pixels around
/// (docs/decisions/0131). It falls as the samples grow.
///
/// Pre: planes of the same size, `samples` above 0.
float even_share(std::span<const SampleKnowledge> halves, double samples);

}  // namespace covtrace
