#include "reconstruction/denoiser_blend.h"

#include <algorithm>
#include <array>

#include "core/vec.h"
#include "reconstruction/coarse_to_fine.h"

namespace covtrace {

namespace {

// The constants p_0, r and c of own_share (docs/decisions/0085).
constexpr float kPriorShare = 0.2f, kPriorWeight = 0.1f, kLostWeight = 100;
constexpr float kSmoothing = 4;  ///< smoothing of the light that was cut off, pixels

}  // namespace

ColorPlanes prior_blend(const ColorPlanes& own, const Denoised& denoised) {
    ColorPlanes blend = own;
    for (size_t k = 0; k < 3; ++k)
        for (size_t i = 0; i < blend[k].size(); ++i)
            blend[k][i] = kPriorShare * own[k][i] + (1 - kPriorShare) * denoised.whole[k][i];
    return blend;
}

Plane own_share(const BlendInput& input, const Denoised& denoised, const Likeness& likeness) {
    const int w = input.g[0].width, h = input.g[0].height;
    // The minimum of own_share is the ratio of two sums. Their parts are collected here.
    enum Part : size_t { kProduct, kSquare, kLost, kPrior, kPixels, kParts };
    std::vector<MarginPlane> sums(kParts, MarginPlane(w, h));
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) sums[kPixels](x, y) = 1;
    for (size_t k = 0; k < 3; ++k) {
        const Plane lost = gaussian_blur(input.lost[k], kSmoothing);
        for (int y = 0; y < h; ++y)
            for (int x = 0; x < w; ++x) {
                const size_t i = size_t(y) * size_t(w) + size_t(x);
                float product = 0, square = 0, noise = 0;
                for (size_t half = 0; half < 2; ++half) {
                    const float d = denoised.half[half][k][i], step = input.own[half][k][i] - d;
                    product += 0.5f * step * (input.samples[1 - half][k][i] - d);
                    square += 0.5f * sqr(step);
                    noise += 0.5f * input.variance[half][k][i];
                }
                const float g = input.g[k][i];
                sums[kProduct](x, y) += g * product;
                sums[kSquare](x, y) += g * square;
                sums[kLost](x, y) += g * kLostWeight * sqr(lost[i]);
                sums[kPrior](x, y) += g * 2 * kPriorWeight * noise;
            }
    }
    Plane share(w, h, kPriorShare);
    const auto judge = [&](int x, int y) {
        Likeness::Window weights;
        likeness.weigh(x, y, weights);
        std::array<float, kParts> sum;
        weighted_sums(sums, weights, x, y, sum.data());
        const float alike = sum[kPixels], prior = sum[kPrior] * likeness.most(x, y, w, h) / alike,
                    prior_share = kPriorShare / (1 + sum[kLost] / alike),
                    all = sum[kSquare] + sum[kLost] + prior;
        if (all > 0)
            share(x, y) = std::clamp((sum[kProduct] + prior_share * prior) / all, 0.0f, 1.0f);
    };
    const auto alike = [&](int x, int y, int u, int v) { return likeness.are_alike(x, y, u, v); };
    coarse_to_fine(w, h, judge, alike, [&](int x, int y, int left, int top, int right, int bottom) {
        share(x, y) = 0.25f * ((share(left, top) + share(right, top)) +
                               (share(left, bottom) + share(right, bottom)));
    });
    return share;
}

}  // namespace covtrace
