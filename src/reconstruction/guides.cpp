#include "reconstruction/guides.h"

#include <algorithm>
#include <cmath>

#include "core/vec.h"
#include "reconstruction/luminance.h"

namespace covtrace {

namespace {

/// Smoothing that keeps the samples' own noise from telling pixels apart, pixels.
constexpr float kSmoothing = 1;
/// Units of the guides: a step that counts as a difference. 0.7 and 1.4 times as much of light and
/// noise, and half of those of features, change the error by less than 1 % (docs/decisions/0094).
constexpr float kAlbedo = 0.3f, kNormal = 0.5f, kLogDepth = 0.3f, kLogLight = 0.35f,
                kLogNoise = 0.35f;
/// Light and squared relative noise below which nothing is told apart: they keep the logarithms
/// finite.
constexpr float kDark = 0.03f, kClean = 1e-5f;

}  // namespace

Plane feature_guide(const Halves& halves, size_t f) {
    constexpr std::array<float, kFeatures> kUnit{kAlbedo, kAlbedo, kAlbedo,  kNormal,
                                                 kNormal, kNormal, kLogDepth};
    Plane mean = halves[0].feature[f];
    for (size_t i = 0; i < mean.size(); ++i)
        mean[i] = 0.5f * (mean[i] + halves[1].feature[f][i]) / kUnit[f];
    return gaussian_blur(mean, kSmoothing);
}

Plane light_guide(const Plane& luminance) {
    Plane logarithm = gaussian_blur(luminance, kSmoothing);
    for (float& v : logarithm.values) v = std::log(std::abs(v) + kDark) / kLogLight;
    return logarithm;
}

void add_features(const Halves& halves, Likeness& likeness) {
    for (size_t f = 0; f < kFeatures; ++f) likeness.add(feature_guide(halves, f));
}

void add_light_and_noise(const Halves& halves, const ColorPlanes& guess, Likeness& likeness) {
    const Plane light = luminance(guess);
    Plane noise(light.width, light.height);
    for (const HalfBuffer& half : halves)
        for (const Plane& variance : half.color_variance)
            for (size_t i = 0; i < noise.size(); ++i) noise[i] += variance[i];
    noise = gaussian_blur(noise, kSmoothing);
    for (size_t i = 0; i < noise.size(); ++i)
        noise[i] = 0.5f * std::log(noise[i] / (sqr(light[i]) + kDarkSquared) + kClean) / kLogNoise;
    likeness.add(noise);
    likeness.add(light_guide(light));
}

}  // namespace covtrace
