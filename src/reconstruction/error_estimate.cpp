#include "reconstruction/error_estimate.h"

#include <cmath>

#include "core/parallel.h"
#include "core/vec.h"

namespace covtrace {

namespace {

// docs/decisions/0041 has the fit.
constexpr float kNoise = 1.6f, kNoiseOfFew = 6.7f, kRaw = 0.005f, kSpread = 0.22f;
constexpr float kSmoothing = 3;  // pixels

float samples_per_pixel(const Halves& halves) {
    double sum = 0;
    for (const HalfBuffer& half : halves)
        for (float count : half.count.values) sum += double(count);
    return float(sum / double(halves[0].count.size()));
}

}  // namespace

Plane estimate_error(const Halves& halves, std::span<const Candidate> candidates,
                     const Selection& selection, const ColorPlanes& image, const ColorPlanes& g) {
    const int w = g[0].width, h = g[0].height;
    const float noise = kNoise + kNoiseOfFew / std::sqrt(std::max(1.0f, samples_per_pixel(halves)));
    Plane error(w, h), known(w, h);
    parallel_for(h, [&](int64_t row) {
        for (size_t i = size_t(row) * size_t(w), end = i + size_t(w); i < end; ++i) {
            known[i] = g[0][i] > 0 ? 1.0f : 0.0f;
            for (size_t k = 0; k < 3; ++k) {
                const float ma = selection.half[0][k][i], mb = selection.half[1][k][i];
                float spread = 0;
                for (size_t c = 0; c < candidates.size(); ++c)
                    spread += selection.share[c][i] *
                              sqr(candidates[c][0][k][i] + candidates[c][1][k][i] - ma - mb);
                error[i] += g[k][i] / 12 *
                            (noise * sqr(ma - mb) +
                             kRaw * sqr(halves[0].color[k][i] - halves[1].color[k][i]) +
                             kSpread * spread + sqr(2 * image[k][i] - ma - mb));
            }
        }
    });
    // The mean over the pixels that both halves know.
    error = gaussian_blur(error, kSmoothing);
    known = gaussian_blur(known, kSmoothing);
    for (size_t i = 0; i < error.size(); ++i) error[i] = known[i] > 0 ? error[i] / known[i] : 0.0f;
    return error;
}

}  // namespace covtrace
