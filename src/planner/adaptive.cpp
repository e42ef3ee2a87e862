#include "planner/adaptive.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace covtrace {

namespace {

/// Deviation in pixels of the Gaussian over which brightness and noise are averaged.
constexpr float kSmoothing = 1.5f;

}  // namespace

std::vector<float> adaptive_density(const SampleKnowledge& known, const PlanSettings& settings) {
    // Deviation of the narrowest filter, pixels: spectra beyond it ask for nothing more.
    constexpr float kNarrowest = 0.35f, kSharpness = 2;
    const Plane brightness = gaussian_blur(known.brightness, kSmoothing);
    Plane noise(known.variance.width, known.variance.height);
    for (size_t i = 0; i < noise.size(); ++i)
        noise[i] = known.variance[i] / (brightness[i] * brightness[i] + settings.dark_squared);
    if (!settings.own) noise = gaussian_blur(noise, kSmoothing);
    for (float& v : noise.values) v = std::sqrt(v);
    if (settings.own) noise = gaussian_blur(noise, kSmoothing);
    std::vector<float> density(noise.size());
    for (size_t i = 0; i < density.size(); ++i) {
        const auto usable = covariance::limit_spectrum(known.spectrum[i], kSharpness, kNarrowest,
                                                       settings.widest_filter);
        const float detail =
            std::pow(std::max(covariance::det(usable), 0.0f), settings.spectrum_power);
        density[i] = noise[i] * detail / std::sqrt(std::max(known.cost[i], 1.0f));
        if (known.emphasis.size() > 0) density[i] *= known.emphasis[i];
    }
    return relative(std::move(density));
}

std::vector<float> relative(std::vector<float> density) {
    double sum = 0;
    for (float& d : density) {
        if (!std::isfinite(d)) d = 0;
        sum += d;
    }
    const float mean = density.empty() ? 0.0f : float(sum / double(density.size()));
    for (float& d : density) d = covariance::share_of_budget(d, mean, 1.0f, 0.0f);
    return density;
}

std::vector<float> density_of_noise_left(const FilteredKnowledge& known,
                                         std::span<const float> predicted) {
    // Deviation in pixels over which noise is averaged, and the predicted density's exponent
    // (docs/decisions/0128)
    constexpr float kNoiseSmoothing = 1.2f, kPredicted = 0.35f;
    const Plane brightness = gaussian_blur(known.brightness, kSmoothing);
    Plane noise(known.variance.width, known.variance.height);
    for (size_t i = 0; i < noise.size(); ++i) {
        const float relative_variance =
            known.variance[i] / (brightness[i] * brightness[i] + kOwnPlan.dark_squared);
        const float v = known.count[i] * relative_variance;
        noise[i] = std::isfinite(v) ? v : 0.0f;
    }
    noise = gaussian_blur(noise, kNoiseSmoothing);
    std::vector<float> density(noise.size());
    for (size_t i = 0; i < density.size(); ++i)
        density[i] = std::pow(noise[i], (1 - kPredicted) / 2) * std::pow(predicted[i], kPredicted);
    return relative(std::move(density));
}

void spread_evenly(std::span<float> density, float share) {
    for (float& v : density) v = covariance::share_of_budget(v, 1.0f, 1.0f, share);
}

}  // namespace covtrace
