#include "planner/adaptive.h"

#include <algorithm>
#include <cmath>

namespace covtrace {

std::vector<float> adaptive_density(const SampleKnowledge& known, float tempering) {
    constexpr float kDark = 0.01f;  // the measure's: errors of dark pixels count as they are
    constexpr float kSmoothing = 1.5f;
    constexpr float kEvenShare = 0.1f;
    // Filters between these deviations exist (pixels), so spectra beyond them ask for nothing more.
    constexpr float kNarrowest = 0.35f, kWidest = 15, kSharpness = 2;
    const Plane variance = gaussian_blur(known.variance, kSmoothing);
    const Plane brightness = gaussian_blur(known.brightness, kSmoothing);
    std::vector<float> density(variance.size());
    double sum = 0;
    for (size_t i = 0; i < density.size(); ++i) {
        const auto usable =
            covariance::limit_spectrum(known.spectrum[i], kSharpness, kNarrowest, kWidest);
        const float detail = std::pow(std::max(covariance::det(usable), 0.0f), tempering);
        const float relative = std::sqrt(variance[i] / (brightness[i] * brightness[i] + kDark));
        density[i] = relative * detail / std::sqrt(std::max(known.cost[i], 1.0f));
        if (!std::isfinite(density[i])) density[i] = 0;
        sum += density[i];
    }
    const float mean = density.empty() ? 0.0f : float(sum / double(density.size()));
    for (float& v : density) v = covariance::share_of_budget(v, mean, 1.0f, kEvenShare);
    return density;
}

}  // namespace covtrace
