#include "planner/even_share.h"

#include <cmath>

#include "core/vec.h"

namespace covtrace {

namespace {

/// Deviation in pixels of the average of noise and brightness: single pixels have not met the rare
/// paths that make the noise of all.
constexpr float kAround = 6;
/// Power of the image's share of noise: most images keep what the plan tells, as a half that is
/// noise makes an eighth even.
constexpr double kPowerOfNoise = 3;

/// The mean of r / (1 + r) over the image.
double share_of_noise(const SampleKnowledge& known, double samples) {
    const Plane variance = gaussian_blur(known.variance, kAround),
                brightness = gaussian_blur(known.brightness, kAround);
    const double dark = double(dark_squared(kOwnPlan, known.brightness));
    double sum = 0;
    for (size_t i = 0; i < variance.size(); ++i) {
        const double noise = double(variance[i]) / samples,
                     all = noise + sqr(double(brightness[i])) + dark;
        // Pixels too bright for squares have no share that could be told
        if (std::isfinite(all)) sum += noise / all;
    }
    return variance.size() > 0 ? sum / double(variance.size()) : 0;
}

}  // namespace

float even_share(std::span<const SampleKnowledge> halves, double samples) {
    double noise = 0;
    for (const SampleKnowledge& half : halves)
        noise += share_of_noise(half, samples) / double(halves.size());
    return std::lerp(kLeastEvenShare, 1.0f, float(std::pow(noise, kPowerOfNoise)));
}

}  // namespace covtrace
