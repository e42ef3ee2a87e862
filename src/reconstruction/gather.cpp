#include "reconstruction/gather.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"
#include "core/simd.h"

namespace covtrace {

namespace {

using Sym2 = covariance::Sym2<float>;

/// One level of the pyramid: N sums over 2^level x 2^level pixels.
template <size_t N>
struct Level {
    Level(int w, int h) : width(w), height(h), stride(size_t(w) + kLanes) {
        for (auto& plane : sums) plane.resize(stride * size_t(h));
    }
    size_t index(int x, int y) const { return size_t(y) * stride + size_t(x); }

    int width, height;
    size_t stride;  // rows end with zeros, so that whole vectors may be read from any pixel
    std::array<std::vector<float>, N> sums;
};

template <size_t N>
Level<N> halve(const Level<N>& fine) {
    Level<N> coarse((fine.width + 1) / 2, (fine.height + 1) / 2);
    parallel_for_rows(coarse.width, coarse.height, [&](int y) {
        for (size_t k = 0; k < N; ++k)
            for (int x = 0; x < coarse.width; ++x) {
                float& sum = coarse.sums[k][coarse.index(x, y)];
                for (int fy = 2 * y; fy < std::min(2 * y + 2, fine.height); ++fy)
                    for (int fx = 2 * x; fx < std::min(2 * x + 2, fine.width); ++fx)
                        sum += fine.sums[k][fine.index(fx, fy)];
            }
    });
    return coarse;
}

template <size_t N>
using Pyramid = std::vector<Level<N>>;

template <size_t N>
Pyramid<N> pyramid_over(Level<N> base) {
    constexpr size_t kMostLevels = 12;
    Pyramid<N> levels;
    levels.push_back(std::move(base));
    while (levels.size() < kMostLevels && std::max(levels.back().width, levels.back().height) > 1)
        levels.push_back(halve(levels.back()));
    return levels;
}

constexpr float kCut = 9;  // squared number of standard deviations

/// Sums weighted by the Gaussian with covariance `s` (level pixels^2) about (cx, cy) (level pixel
/// coordinates), those of plane `Squared` by its square.
template <size_t Squared, size_t N>
std::array<float, N> gaussian_sums(const Level<N>& level, float cx, float cy, const Sym2& s) {
    const float determinant = s.xx * s.yy - s.xy * s.xy;
    const float qxx = s.yy / determinant, qxy = -s.xy / determinant, qyy = s.xx / determinant;
    const float reach_y = std::sqrt(kCut * s.yy);
    const int y0 = std::max(0, int(std::ceil(cy - reach_y)));
    const int y1 = std::min(level.height - 1, int(std::floor(cy + reach_y)));
    Float8 lane;
    for (size_t k = 0; k < kLanes; ++k) lane[k] = float(k);
    std::array<Float8, N> sum{};
    for (int y = y0; y <= y1; ++y) {
        // The row's chord of the ellipse: qxx x^2 + 2 qxy x dy + qyy dy^2 <= cut.
        const float dy = float(y) - cy;
        const float centre = -qxy * dy / qxx;
        const float rest = kCut - dy * dy / s.yy;
        const float half = std::sqrt(std::max(0.0f, rest / qxx));
        const int x0 = std::max(0, int(std::ceil(cx + centre - half)));
        const int x1 = std::min(level.width - 1, int(std::floor(cx + centre + half)));
        for (int x = x0; x <= x1; x += int(kLanes)) {
            const Float8 dx = lane + (float(x) - cx);
            const Float8 power =
                multiply_add(-0.5f * dx, qxx * dx + 2 * qxy * dy, -0.5f * qyy * dy * dy - Float8{});
            const Float8 h = lane <= float(x1 - x) ? exp_of_negative(power) : Float8{};
            const size_t at = level.index(x, y);
            for (size_t k = 0; k < N; ++k)
                sum[k] = multiply_add(k == Squared ? h * h : h, load8(&level.sums[k][at]), sum[k]);
        }
    }
    std::array<float, N> result;
    for (size_t k = 0; k < N; ++k) result[k] = sum8(sum[k]);
    return result;
}

/// Sums as gaussian_sums gives them around a pixel of the image, with `s` in the image's pixels^2,
/// from the level that suits the filter.
template <size_t Squared, size_t N>
std::array<float, N> sums_around(const Pyramid<N>& pyramid, int x, int y, const Sym2& s) {
    const float narrow = std::sqrt(std::max(0.0f, covariance::eigen(s).low));
    size_t level = 0;
    while (level + 1 < pyramid.size() && float(2 << level) <= 0.5f * narrow) ++level;
    const float size = float(1 << level);
    // Boxes of this size have blurred already, by (size^2 - 1) / 12 compared with single pixels.
    const float blurred = (size * size - 1) / 12;
    const Sym2 rest{(s.xx - blurred) / (size * size), s.xy / (size * size),
                    (s.yy - blurred) / (size * size)};
    return gaussian_sums<Squared>(pyramid[level], (float(x) + 0.5f) / size - 0.5f,
                                  (float(y) + 0.5f) / size - 0.5f, rest);
}

/// Least sum of weights: below it nothing is near, and the filter is made four times as wide (its
/// covariance 16 times).
constexpr float kLeastWeight = 1e-3f, kFourTimesAsWide = 16;
constexpr int kAttempts = 6;

/// `gather`, with as many features as there are.
template <size_t Features>
FilteredImage gather_all(std::span<const Rgb> mean, std::span<const float> variance,
                         std::span<const uint32_t> count, const FilterField& field,
                         std::span<Plane, Features> features) {
    // Sums of red, green, blue, the variance of the luminance, whether a pixel has samples, and the
    // features.
    constexpr size_t kVariance = 3, kWeight = 4, kFeatures = 5, kSums = kFeatures + Features;
    Level<kSums> base(field.width, field.height);
    for (int y = 0; y < base.height; ++y)
        for (int x = 0; x < base.width; ++x) {
            const size_t i = size_t(y) * size_t(base.width) + size_t(x), at = base.index(x, y);
            if (count[i] == 0 || !is_finite(mean[i])) continue;
            for (int c = 0; c < 3; ++c) base.sums[size_t(c)][at] = mean[i][c];
            base.sums[kVariance][at] = std::isfinite(variance[i]) ? variance[i] : 0.0f;
            base.sums[kWeight][at] = 1;
            for (size_t k = 0; k < Features; ++k) base.sums[kFeatures + k][at] = features[k][i];
        }
    const Pyramid<kSums> pyramid = pyramid_over(std::move(base));
    for (Plane& feature : features) feature = Plane(field.width, field.height);
    FilteredImage result{std::vector<Rgb>(mean.size()), std::vector<float>(mean.size()),
                         std::vector<float>(mean.size())};
    parallel_for_rows(field.width, field.height, [&](int y) {
        for (int x = 0; x < field.width; ++x) {
            const size_t i = size_t(y) * size_t(field.width) + size_t(x);
            Sym2 s = field.covariance[i];
            for (int attempt = 0; attempt < kAttempts; ++attempt, s = kFourTimesAsWide * s) {
                const std::array<float, kSums> sum = sums_around<kVariance>(pyramid, x, y, s);
                const float all = sum[kWeight];
                if (!(all > 0)) continue;
                result.color[i] = Rgb(sum[0], sum[1], sum[2]) / all;
                result.variance[i] = sum[kVariance] / (all * all);
                result.own_weight[i] = count[i] > 0 ? std::min(1.0f, 1 / all) : 0.0f;
                for (size_t k = 0; k < Features; ++k) features[k][i] = sum[kFeatures + k] / all;
                if (all > kLeastWeight) break;
            }
        }
    });
    return result;
}

}  // namespace

FilteredImage gather(std::span<const Rgb> mean, std::span<const float> variance,
                     std::span<const uint32_t> count, const FilterField& field) {
    return gather_all<0>(mean, variance, count, field, {});
}

FilteredImage gather(std::span<const Rgb> mean, std::span<const float> variance,
                     std::span<const uint32_t> count, const FilterField& field,
                     std::span<Plane, kGatheredFeatures> features) {
    return gather_all(mean, variance, count, field, features);
}

std::array<ColorPlanes, 2> gather(const Halves& halves, const FilterField& field) {
    // Sums of each half: red, green, blue, and whether a pixel has samples.
    constexpr size_t kWeight = 3, kOfHalf = 4, kSums = 2 * kOfHalf;
    Level<kSums> base(field.width, field.height);
    std::array<ColorPlanes, 2> result;
    for (size_t k = 0; k < 2; ++k) {
        result[k].fill(Plane(field.width, field.height));
        for (int y = 0; y < base.height; ++y)
            for (int x = 0; x < base.width; ++x) {
                if (!(halves[k].count(x, y) > 0)) continue;
                const size_t at = base.index(x, y);
                for (size_t c = 0; c < 3; ++c)
                    base.sums[k * kOfHalf + c][at] = halves[k].color[c](x, y);
                base.sums[k * kOfHalf + kWeight][at] = 1;
            }
    }
    const Pyramid<kSums> pyramid = pyramid_over(std::move(base));
    parallel_for_rows(field.width, field.height, [&](int y) {
        for (int x = 0; x < field.width; ++x) {
            Sym2 s = field.covariance[size_t(y) * size_t(field.width) + size_t(x)];
            std::array<bool, 2> done{};
            for (int attempt = 0; attempt < kAttempts && !(done[0] && done[1]);
                 ++attempt, s = kFourTimesAsWide * s) {
                const std::array<float, kSums> sum = sums_around<kSums>(pyramid, x, y, s);
                for (size_t k = 0; k < 2; ++k) {
                    const float* of_half = &sum[k * kOfHalf];
                    if (done[k] || !(of_half[kWeight] > 0)) continue;
                    for (size_t c = 0; c < 3; ++c)
                        result[k][c](x, y) = of_half[c] / of_half[kWeight];
                    done[k] = of_half[kWeight] > kLeastWeight;
                }
            }
        }
    });
    return result;
}

}  // namespace covtrace
