/// The candidates: ways to reconstruct, among which the hybrid method chooses.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "reconstruction/filter_field.h"
#include "reconstruction/half_buffer.h"
#include "reconstruction/regression.h"

namespace covtrace {

/// A candidate: one way to reconstruct, applied to each half by itself, from that half's samples.
using Candidate = std::array<ColorPlanes, 2>;

/// Settings of the candidates beside the raw pixels. What each candidate gains:
/// docs/decisions/0094.
struct CandidateSettings {
    /// Scales of the predicted Gaussians; 1 stands for the width factor c = 2.
    std::vector<float> gaussians{0.5f, 1.0f};
    /// A first-order regression: tolerance of the colours' patches, whether the window also falls
    /// off as the predicted Gaussian, 2.5 times as wide, the features that explain the colours, and
    /// the patches that are compared.
    struct Fit {
        float k;
        bool shaped = false;
        FeatureNoise noise = FeatureNoise::filtered;
        PatchesOf patches = PatchesOf::colors;
    };
    std::vector<Fit> fits{{0.5f, false, FeatureNoise::kept, PatchesOf::colors_or_light},
                          {2.0f},
                          {1.0f, true},
                          {4.0f, true, FeatureNoise::filtered, PatchesOf::colors_or_light}};
};

enum class CandidateKind : uint8_t { raw, gaussian, regression, denoiser };

/// Kind of the candidate at `index`; the denoiser's comes after those of make_candidates.
CandidateKind candidate_kind(const CandidateSettings& settings, size_t index);

/// Makes the candidates: the raw pixels, the Gaussians, the fits, in this order. `spectrum`: the
/// predicted spectra after the integral over lens and shutter, (cycles/pixel)^2, one per pixel; empty
/// where there is no prediction: then there are no Gaussians, and all windows are plain. The
/// variances of the halves are smoothed: variances that know of their own pixel's mean would let
/// bright pixels accept dark ones and not the other way round.
std::vector<Candidate> make_candidates(const Halves& halves,
                                       std::span<const covariance::Sym2<float>> spectrum,
                                       const CandidateSettings& settings);

}  // namespace covtrace
