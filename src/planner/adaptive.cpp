#include "planner/adaptive.h"

#include <algorithm>
#include <cmath>

namespace covtrace {

std::vector<float> adaptive_density(const SampleKnowledge& known, const PlanSettings& settings) {
    constexpr float kSmoothing = 1.5f;
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
    double sum = 0;
    for (size_t i = 0; i < density.size(); ++i) {
        const auto usable = covariance::limit_spectrum(known.spectrum[i], kSharpness, kNarrowest,
                                                       settings.widest_filter);
        const float detail =
            std::pow(std::max(covariance::det(usable), 0.0f), settings.spectrum_power);
        density[i] = noise[i] * detail / std::sqrt(std::max(known.cost[i], 1.0f));
        if (known.emphasis.size() > 0) density[i] *= known.emphasis[i];
        if (!std::isfinite(density[i])) density[i] = 0;
        sum += density[i];
    }
    const float mean = density.empty() ? 0.0f : float(sum / double(density.size()));
    for (float& v : density) v = covariance::share_of_budget(v, mean, 1.0f, 0.0f);
    return density;
}

void spread_evenly(std::span<float> density, float share) {
    for (float& v : density) v = covariance::share_of_budget(v, 1.0f, 1.0f, share);
}

}  // namespace covtrace
