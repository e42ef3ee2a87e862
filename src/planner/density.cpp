#include "planner/density.h"

#include <cmath>

namespace covtrace {

using PredictedRule = covariance::DensityRule;

Plane emphasis(const Prediction& prediction, PredictedRule rule, float c,
               const covariance::FilterLimits<float>& limits) {
    constexpr float kExponent = 0.7f, kSmoothing = 3;  // pixels
    Plane beyond(prediction.width, prediction.height, 1);
    if (rule == PredictedRule::tempered) return beyond;
    const std::vector<float> asked = covariance::densities(prediction, rule, c, limits),
                             tempered = covariance::densities(prediction, PredictedRule::tempered,
                                                              c, limits);
    for (size_t i = 0; i < beyond.size(); ++i)
        beyond[i] = tempered[i] > 0 ? std::pow(asked[i] / tempered[i], kExponent) : 0.0f;
    return gaussian_blur(beyond, kSmoothing);
}

std::vector<uint32_t> allocate_on_demand(std::span<const float> density, int64_t total,
                                         std::span<const uint32_t> have, uint32_t at_most) {
    return covariance::counts_by_density(
        density, total, have, [&](size_t i) { return double(have[i]) + double(at_most); });
}

}  // namespace covtrace
