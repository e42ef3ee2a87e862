#include "reconstruction/guided_gather.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "core/simd.h"

namespace covtrace {

namespace {

using Sym2 = covariance::Sym2<float>;

/// Differences of the guides that are one deviation of their Gaussian: docs/decisions/0108 has the
/// sweep.
constexpr float kAlbedoReach = 0.2f, kNormalReach = 0.2f, kLogDistanceReach = 0.1f;

/// Least albedo by which light is divided: a dark texture says little of its light.
constexpr float kLeastAlbedo = 0.02f;

constexpr float kCut = 9;  // squared number of standard deviations

/// Weights below exp(-16) are none.
constexpr float kLeastPower = -16;

constexpr size_t kScales = kGuidedScales.size();
constexpr size_t kGuides = 7;
/// Sums by the weight: red, green and blue of light without its texture, the same with it, whether
/// a pixel has samples. By the squared weight: the variances of both lights' luminance.
constexpr size_t kTextured = 3, kWeight = 6, kVariance = 7, kSums = 9;

Rgb albedo_of(const FilterGuides& guides, size_t i) {
    const Rgb& a = guides.albedo[i];
    return {std::max(a.r, kLeastAlbedo), std::max(a.g, kLeastAlbedo), std::max(a.b, kLeastAlbedo)};
}

/// Guides and gathered light in rows that end with zeros, so that whole vectors may be read
/// from any pixel.
struct Rows {
    Rows(int w, int h) : stride(size_t(w) + kLanes) {
        for (auto& plane : guides) plane.resize(stride * size_t(h));
        for (auto& plane : sums) plane.resize(stride * size_t(h));
    }
    size_t index(int x, int y) const { return size_t(y) * stride + size_t(x); }

    size_t stride;
    std::array<std::vector<float>, kGuides> guides;  // in deviations of their Gaussian
    std::array<std::vector<float>, kSums> sums;
};

Rows rows_of(std::span<const Rgb> mean, std::span<const float> variance,
             std::span<const uint32_t> count, const FilterField& field,
             const FilterGuides& guides) {
    Rows rows(field.width, field.height);
    parallel_for_rows(field.width, field.height, [&](int y) {
        for (int x = 0; x < field.width; ++x) {
            const size_t i = size_t(y) * size_t(field.width) + size_t(x), at = rows.index(x, y);
            for (int c = 0; c < 3; ++c) {
                rows.guides[size_t(c)][at] = guides.albedo[i][c] / kAlbedoReach;
                rows.guides[size_t(c) + 3][at] = guides.normal[i][c] / kNormalReach;
            }
            rows.guides[6][at] = guides.log_distance[i] / kLogDistanceReach;
            if (count[i] == 0 || !is_finite(mean[i])) continue;
            const Rgb albedo = albedo_of(guides, i), light = mean[i] / albedo;
            for (int c = 0; c < 3; ++c) {
                rows.sums[size_t(c)][at] = light[c];
                rows.sums[kTextured + size_t(c)][at] = mean[i][c];
            }
            rows.sums[kWeight][at] = 1;
            if (!std::isfinite(variance[i])) continue;
            rows.sums[kVariance][at] = variance[i] / sqr(luminance(albedo));
            rows.sums[kVariance + 1][at] = variance[i];
        }
    });
    return rows;
}

/// The squared differences of the guides of eight pixels to those of another.
Float8 differences(const Rows& rows, size_t at, const std::array<float, kGuides>& own) {
    Float8 sum{};
    for (size_t g = 0; g < kGuides; ++g) {
        const Float8 d = load8(&rows.guides[g][at]) - own[g];
        sum = multiply_add(d, d, sum);
    }
    return sum;
}

using ScaledSums = std::array<std::array<float, kSums>, kScales>;

/// Sums around a pixel by the Gaussian `s` at every scale times that of the guides.
ScaledSums sums_around(const Rows& rows, const FilterField& field, int x, int y) {
    const Sym2& s = field.covariance[size_t(y) * size_t(field.width) + size_t(x)];
    const float determinant = s.xx * s.yy - s.xy * s.xy;
    const float qxx = s.yy / determinant, qxy = -s.xy / determinant, qyy = s.xx / determinant;
    std::array<float, kScales> narrowing;  // of the powers, by the squared scale
    for (size_t k = 0; k < kScales; ++k)
        narrowing[k] = s.xx / scaled_filter(s, kGuidedScales[k]).xx;
    // Scales beyond the widest deviation are the same filter.
    const size_t scales = size_t(std::find(narrowing.begin(), narrowing.end(), narrowing.back()) -
                                 narrowing.begin()) +
                          1;
    const float widest = 1 / narrowing.back();
    const float cut = kCut * widest, reach_y = std::sqrt(cut * s.yy);
    std::array<float, kGuides> own;
    for (size_t g = 0; g < kGuides; ++g) own[g] = rows.guides[g][rows.index(x, y)];
    Float8 lane;
    for (size_t k = 0; k < kLanes; ++k) lane[k] = float(k);
    std::array<std::array<Float8, kSums>, kScales> sum{};
    const int y0 = std::max(0, y - int(reach_y)), y1 = std::min(field.height - 1, y + int(reach_y));
    for (int row = y0; row <= y1; ++row) {
        // The row's chord of the widest ellipse.
        const float dy = float(row - y), centre = -qxy * dy / qxx;
        const float half = std::sqrt(std::max(0.0f, (cut - dy * dy / s.yy) / qxx));
        const int x0 = std::max(0, x + int(std::ceil(centre - half)));
        const int x1 = std::min(field.width - 1, x + int(std::floor(centre + half)));
        for (int column = x0; column <= x1; column += int(kLanes)) {
            const size_t at = rows.index(column, row);
            const Float8 guided = -0.5f * differences(rows, at, own);
            const Mask8 inside = (lane <= float(x1 - column)) & (guided > kLeastPower);
            if (bits8(inside) == 0) continue;
            const Float8 dx = lane + float(column - x);
            const Float8 square = multiply_add(dx, qxx * dx + 2 * qxy * dy, all8(qyy * dy * dy));
            std::array<Float8, kSums> value;
            for (size_t k = 0; k < kSums; ++k) value[k] = load8(&rows.sums[k][at]);
            for (size_t k = 0; k < scales; ++k) {
                const Float8 distance = narrowing[k] * square;
                const Mask8 within = inside & (distance <= kCut);
                // Narrow scales see few of the pixels that the widest one does
                if (bits8(within) == 0) continue;
                const Float8 h = within
                                     ? exp_of_negative(multiply_add(all8(-0.5f), distance, guided))
                                     : Float8{};
                const Float8 squared = h * h;
                for (size_t j = 0; j < kSums; ++j)
                    sum[k][j] = multiply_add(j < kVariance ? h : squared, value[j], sum[k][j]);
            }
        }
    }
    ScaledSums result;
    for (size_t k = 0; k < kScales; ++k)
        for (size_t j = 0; j < kSums; ++j) result[k][j] = sum8(sum[std::min(k, scales - 1)][j]);
    return result;
}

}  // namespace

covariance::Sym2<float> scaled_filter(const covariance::Sym2<float>& filter, float scale) {
    const float deviation = std::sqrt(std::max(0.0f, 0.5f * (filter.xx + filter.yy)));
    return sqr(std::min(scale, kWidestScaled / std::max(deviation, 1e-6f))) * filter;
}

std::vector<FilteredImage> guided_gather(std::span<const Rgb> mean, std::span<const float> variance,
                                         std::span<const uint32_t> count, const FilterField& field,
                                         const FilterGuides& guides) {
    const Rows rows = rows_of(mean, variance, count, field, guides);
    std::vector<FilteredImage> candidates(2 * kScales);
    for (FilteredImage& c : candidates)
        c = {std::vector<Rgb>(mean.size()),
             std::vector<float>(mean.size(), std::numeric_limits<float>::infinity()),
             std::vector<float>(mean.size())};
    parallel_for_rows(field.width, field.height, [&](int y) {
        for (int x = 0; x < field.width; ++x) {
            const size_t i = size_t(y) * size_t(field.width) + size_t(x);
            const ScaledSums sums = sums_around(rows, field, x, y);
            const Rgb albedo = albedo_of(guides, i);
            for (size_t k = 0; k < kScales; ++k) {
                const std::array<float, kSums>& sum = sums[k];
                const float all = sum[kWeight];
                if (!(all > 0)) continue;
                FilteredImage &without = candidates[2 * k], &with = candidates[2 * k + 1];
                without.color[i] = albedo * Rgb(sum[0], sum[1], sum[2]) / all;
                without.variance[i] = sum[kVariance] * sqr(luminance(albedo) / all);
                with.color[i] = Rgb(sum[kTextured], sum[kTextured + 1], sum[kTextured + 2]) / all;
                with.variance[i] = sum[kVariance + 1] / sqr(all);
                without.own_weight[i] = with.own_weight[i] = count[i] > 0 ? 1 / all : 0;
            }
        }
    });
    return candidates;
}

}  // namespace covtrace
