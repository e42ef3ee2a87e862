#include "reconstruction/error_estimate.h"

#include <array>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "core/vec.h"
#include "reconstruction/bilateral.h"
#include "reconstruction/luminance.h"
#include "reconstruction/selector.h"

namespace covtrace {

namespace {

constexpr float kSmoothing = 3;  // pixels
/// Largest difference in brightness, as a logarithm, between pixels that are averaged: terms of a
/// bright pixel say nothing of a dark one beside it.
const float kAlike = std::log(1.5f);
/// Signals whose errors are estimated: red, green, blue, luminance.
constexpr size_t kSignals = 4;
using Signals = std::array<float, kSignals>;

Signals signals(const ColorPlanes& color, size_t i) {
    const Rgb c(color[0][i], color[1][i], color[2][i]);
    return {c.r, c.g, c.b, luminance(c)};
}

/// The signals of the mean of both halves.
Signals signals(const std::array<ColorPlanes, 2>& halves, size_t i) {
    Signals a = signals(halves[0], i);
    const Signals b = signals(halves[1], i);
    for (size_t k = 0; k < kSignals; ++k) a[k] = 0.5f * (a[k] + b[k]);
    return a;
}

float samples_per_pixel(const Halves& halves) {
    double sum = 0;
    for (const HalfBuffer& half : halves)
        for (float count : half.count.values) sum += double(count);
    return float(sum / double(halves[0].count.size()));
}

/// The brightness as half the logarithm of Y^2 + eps: differences are ratios, except in the dark.
Plane log_brightness(const Plane& bright) {
    Plane result = bright;
    for (float& v : result.values) v = 0.5f * std::log(sqr(v) + kDarkSquared);
    return result;
}

/// Weights of the pixels: 1 where both halves have samples. Pixels that one half has not seen count
/// only where none around was seen by both: holes are filled, and the halves still differ.
Plane known_by_both(const Halves& halves) {
    constexpr float kFilled = 1e-4f;
    const Plane &a = halves[0].count, &b = halves[1].count;
    Plane known(a.width, a.height);
    for (size_t i = 0; i < known.size(); ++i) known[i] = a[i] > 0 && b[i] > 0 ? 1.0f : kFilled;
    return known;
}

}  // namespace

ErrorEstimate estimate_error(const Halves& halves, std::span<const Candidate> candidates,
                             const Selection& selection, const ColorPlanes& image,
                             const ColorPlanes& raw, const ColorPlanes& brightness,
                             const ColorPlanes* difference_of_sights, const ErrorFactors& factors,
                             float dark_squared) {
    const int w = image[0].width, h = image[0].height;
    const Plane bright = luminance(brightness);
    const float noise =
        factors.noise + factors.noise_of_few / std::max(1.0f, samples_per_pixel(halves));
    const Plane known = known_by_both(halves);
    ErrorEstimate error{Plane(w, h), Plane(w, h)};
    parallel_for_rows(w, h, [&](int row) {
        for (size_t i = size_t(row) * size_t(w), end = i + size_t(w); i < end; ++i) {
            const Signals ma = signals(selection.half[0], i), mb = signals(selection.half[1], i),
                          m = signals(selection.half, i), delivered = signals(image, i),
                          all = signals(raw, i), a = signals(halves[0].color, i),
                          b = signals(halves[1].color, i);
            Signals spread{};
            for (size_t c = 0; c < candidates.size(); ++c) {
                if (selection.share[c][i] == 0) continue;
                const Signals mean = signals(candidates[c], i);
                for (size_t k = 0; k < kSignals; ++k)
                    spread[k] += selection.share[c][i] * std::abs(mean[k] - m[k]);
            }
            Signals sights{};
            if (difference_of_sights) {
                sights = signals(*difference_of_sights, i);
                for (float& v : sights) v *= selection.share.back()[i];
            }
            Signals square;
            for (size_t k = 0; k < kSignals; ++k)
                square[k] = noise * sqr(ma[k] - mb[k]) / 4 + factors.spread * sqr(spread[k]) +
                            factors.returned * sqr(delivered[k] - m[k]) +
                            factors.cut * sqr(all[k] - 0.5f * (a[k] + b[k])) +
                            factors.sights * sqr(sights[k]) / 4;
            for (size_t k = 0; k < 3; ++k)
                error.color[i] += square[k] / (sqr(brightness[k][i]) + dark_squared) / 3;
            error.luminance[i] = square[3] / (sqr(bright[i]) + dark_squared);
        }
    });
    bilateral_blur(std::array{&error.color, &error.luminance}, known, log_brightness(bright),
                   kSmoothing, kAlike);
    // A brightness whose square is no number has no error that could be told, and would have none.
    for (size_t i = 0; i < bright.size(); ++i)
        if (!std::isfinite(sqr(bright[i])))
            error.color[i] = error.luminance[i] = std::numeric_limits<float>::infinity();
    return error;
}

}  // namespace covtrace
