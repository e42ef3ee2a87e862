#include "reconstruction/error_estimate.h"

#include <array>
#include <cmath>

#include "core/parallel.h"
#include "core/vec.h"
#include "reconstruction/bilateral.h"
#include "reconstruction/outliers.h"

namespace covtrace {

namespace {

constexpr float kSmoothing = 3;  // pixels
/// Terms of a bright pixel say nothing of a dark one beside it: only pixels whose
/// brightness differs by less than this factor are averaged.
const float kAlike = std::log(1.5f);
/// Red, green, blue, luminance.
constexpr size_t kSignals = 4;
using Signals = std::array<float, kSignals>;

Signals signals(const ColorPlanes& color, size_t i) {
    const Rgb c(color[0][i], color[1][i], color[2][i]);
    return {c.r, c.g, c.b, luminance(c)};
}

/// The mean of both halves.
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

/// Half the logarithm of Y^2 + eps: differences are ratios of brightness, but in the dark.
Plane log_brightness(const Plane& bright) {
    Plane result = bright;
    for (float& v : result.values) v = 0.5f * std::log(sqr(v) + kDarkSquared);
    return result;
}

}  // namespace

ErrorEstimate estimate_error(const Halves& halves, std::span<const Candidate> candidates,
                             const Selection& selection, const ColorPlanes& image,
                             const ColorPlanes& raw, const Plane& near,
                             const ColorPlanes& brightness, const ErrorFactors& factors) {
    const int w = image[0].width, h = image[0].height;
    const float noise =
        factors.noise + factors.noise_of_few / std::max(1.0f, samples_per_pixel(halves));
    const ColorPlanes g = error_weights(halves, brightness);
    const Plane bright = luminance(brightness);
    const Plane g_luminance = error_weights(halves, {bright, bright, bright})[0];
    ErrorEstimate error{Plane(w, h), Plane(w, h)};
    Plane known(w, h);
    parallel_for(h, [&](int64_t row) {
        for (size_t i = size_t(row) * size_t(w), end = i + size_t(w); i < end; ++i) {
            known[i] = g[0][i] > 0 ? 1.0f : 0.0f;
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
            const float cut = factors.cut * (sqr(near[i]) + sqr((1 - near[i]) / kWidening));
            Signals square;
            for (size_t k = 0; k < kSignals; ++k)
                square[k] = noise * sqr(ma[k] - mb[k]) / 4 + factors.spread * sqr(spread[k]) +
                            factors.returned * sqr(delivered[k] - m[k]) +
                            cut * sqr(all[k] - 0.5f * (a[k] + b[k]));
            for (size_t k = 0; k < 3; ++k) error.color[i] += g[k][i] / 3 * square[k];
            error.luminance[i] = g_luminance[i] * square[3];
        }
    });
    bilateral_blur(std::array{&error.color, &error.luminance}, known, log_brightness(bright),
                   kSmoothing, kAlike);
    return error;
}

}  // namespace covtrace
