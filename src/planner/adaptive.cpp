#include "planner/adaptive.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/display_exposure.h"
#include "core/vec.h"

namespace covtrace {

namespace {

/// Deviation in pixels of the Gaussian over which brightness, noise and cost are averaged.
constexpr float kSmoothing = 1.5f;

}  // namespace

float dark_squared(const PlanSettings& settings, const Plane& brightness) {
    return settings.dark_squared / sqr(display_exposure(brightness));
}

std::vector<float> adaptive_density(const SampleKnowledge& known, const PlanSettings& settings) {
    // Deviation of the narrowest filter, pixels: spectra beyond it ask for nothing more.
    constexpr float kNarrowest = 0.35f, kSharpness = 2;
    const Plane brightness = gaussian_blur(known.brightness, kSmoothing),
                cost = gaussian_blur(known.cost, kSmoothing);
    const float dark = dark_squared(settings, known.brightness);
    Plane noise(known.variance.width, known.variance.height);
    for (size_t i = 0; i < noise.size(); ++i)
        noise[i] = known.variance[i] / (brightness[i] * brightness[i] + dark);
    if (!settings.own) noise = gaussian_blur(noise, kSmoothing);
    for (float& v : noise.values) v = std::sqrt(v);
    if (settings.own) noise = gaussian_blur(noise, kSmoothing);
    std::vector<float> density(noise.size());
    for (size_t i = 0; i < density.size(); ++i) {
        const auto usable = covariance::limit_spectrum(known.spectrum[i], kSharpness, kNarrowest,
                                                       settings.widest_filter);
        const float detail =
            std::pow(std::max(covariance::det(usable), 0.0f), settings.spectrum_power);
        density[i] = noise[i] * detail / std::sqrt(std::max(cost[i], 1.0f));
        if (known.emphasis.size() > 0) density[i] *= known.emphasis[i];
    }
    return scaled_to_mean_one(std::move(density));
}

std::vector<float> scaled_to_mean_one(std::vector<float> density) {
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
    // Deviations in pixels over which noise is averaged, the part of the wider average that a pixel
    // has at least, and the predicted density's exponent (docs/decisions/0128)
    constexpr float kNear = 1.2f, kAround = 2.5f, kPartOfAround = 0.5f, kPredicted = 0.35f;
    const Plane brightness = gaussian_blur(known.brightness, kSmoothing);
    const float dark = dark_squared(kOwnPlan, known.brightness);
    Plane noise(known.variance.width, known.variance.height), told = noise;
    for (size_t i = 0; i < noise.size(); ++i) {
        const float relative_variance = known.variance[i] / (brightness[i] * brightness[i] + dark);
        const float v = known.count[i] * relative_variance;
        // One sample tells no variance, which is not the same as none.
        if (known.count[i] < 2 || !std::isfinite(v)) continue;
        noise[i] = v;
        told[i] = 1;
    }
    const Plane near = gaussian_blur(noise, kNear), told_near = gaussian_blur(told, kNear),
                around = gaussian_blur(noise, kAround), told_around = gaussian_blur(told, kAround);
    std::vector<float> density(noise.size());
    double sum = 0, sum_predicted = 0;
    for (size_t i = 0; i < density.size(); ++i) {
        if (!(told_around[i] > 0)) continue;
        // Where light is rare, pixels that have missed it look less noisy than they are.
        const float v = std::max(told_near[i] > 0 ? near[i] / told_near[i] : 0.0f,
                                 kPartOfAround * around[i] / told_around[i]);
        density[i] = std::pow(v, (1 - kPredicted) / 2) * std::pow(predicted[i], kPredicted);
        sum += density[i];
        sum_predicted += predicted[i];
    }
    // Where nothing is known the prediction stands alone, in the ratio that both have elsewhere
    const float scale = sum > 0 && sum_predicted > 0 ? float(sum / sum_predicted) : 1.0f;
    for (size_t i = 0; i < density.size(); ++i)
        if (!(told_around[i] > 0)) density[i] = scale * predicted[i];
    return scaled_to_mean_one(std::move(density));
}

void spread_evenly(std::span<float> density, float share) {
    for (float& v : density) v = covariance::share_of_budget(v, 1.0f, 1.0f, share);
}

}  // namespace covtrace
