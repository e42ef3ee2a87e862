#include "reconstruction/gather.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"
#include "reconstruction/lanes.h"

namespace covtrace {

namespace {

using Sym2 = covariance::Sym2<float>;

/// One level of the pyramid: sums over 2^level x 2^level pixels.
struct Level {
    enum Sum : size_t {
        red,
        green,
        blue,
        variance,  // of the sum's luminance
        weight,    // how many pixels had samples
        kSums
    };

    Level(int w, int h) : width(w), height(h), stride(size_t(w) + kLanes) {
        for (auto& plane : sums) plane.resize(stride * size_t(h));
    }
    size_t index(int x, int y) const { return size_t(y) * stride + size_t(x); }

    int width, height;
    size_t stride;  // rows end with zeros, so that whole vectors may be read from any pixel
    std::array<std::vector<float>, kSums> sums;
};

Level halve(const Level& fine) {
    Level coarse((fine.width + 1) / 2, (fine.height + 1) / 2);
    parallel_for(coarse.height, [&](int64_t row) {
        const int y = int(row);
        for (size_t k = 0; k < Level::kSums; ++k)
            for (int x = 0; x < coarse.width; ++x) {
                float& sum = coarse.sums[k][coarse.index(x, y)];
                for (int fy = 2 * y; fy < std::min(2 * y + 2, fine.height); ++fy)
                    for (int fx = 2 * x; fx < std::min(2 * x + 2, fine.width); ++fx)
                        sum += fine.sums[k][fine.index(fx, fy)];
            }
    });
    return coarse;
}

constexpr float kCut = 9;  // squared number of standard deviations

/// The Gaussian mean with covariance `s` (level pixels^2) about (cx, cy) (level pixel coordinates).
/// Returns the total weight; `mean` and `variance` are set where it is positive.
float gaussian_mean(const Level& level, float cx, float cy, const Sym2& s, Rgb& mean,
                    float& variance) {
    const float determinant = s.xx * s.yy - s.xy * s.xy;
    const float qxx = s.yy / determinant, qxy = -s.xy / determinant, qyy = s.xx / determinant;
    const float reach_y = std::sqrt(kCut * s.yy);
    const int y0 = std::max(0, int(std::ceil(cy - reach_y)));
    const int y1 = std::min(level.height - 1, int(std::floor(cy + reach_y)));
    Lanes lane;
    for (size_t k = 0; k < kLanes; ++k) lane[k] = float(k);
    std::array<Lanes, Level::kSums> sum{};
    for (int y = y0; y <= y1; ++y) {
        // The row's chord of the ellipse: qxx x^2 + 2 qxy x dy + qyy dy^2 <= cut.
        const float dy = float(y) - cy;
        const float centre = -qxy * dy / qxx;
        const float rest = kCut - dy * dy / s.yy;
        const float half = std::sqrt(std::max(0.0f, rest / qxx));
        const int x0 = std::max(0, int(std::ceil(cx + centre - half)));
        const int x1 = std::min(level.width - 1, int(std::floor(cx + centre + half)));
        for (int x = x0; x <= x1; x += int(kLanes)) {
            const Lanes dx = lane + (float(x) - cx);
            const Lanes power =
                multiply_add(-0.5f * dx, qxx * dx + 2 * qxy * dy, -0.5f * qyy * dy * dy - Lanes{});
            const Lanes h = lane <= float(x1 - x) ? exp_of_negative(power) : Lanes{};
            const size_t at = level.index(x, y);
            for (size_t k = 0; k < Level::kSums; ++k)
                sum[k] = multiply_add(k == Level::variance ? h * h : h, load(&level.sums[k][at]),
                                      sum[k]);
        }
    }
    const float all = total(sum[Level::weight]);
    if (all > 0) {
        mean = Rgb(total(sum[Level::red]), total(sum[Level::green]), total(sum[Level::blue])) / all;
        variance = total(sum[Level::variance]) / (all * all);
    }
    return all;
}

}  // namespace

GatheredImage gather(std::span<const Rgb> mean, std::span<const float> variance,
                     std::span<const uint32_t> count, const FilterField& field) {
    std::vector<Level> pyramid{Level(field.width, field.height)};
    Level& base = pyramid[0];
    for (int y = 0; y < base.height; ++y)
        for (int x = 0; x < base.width; ++x) {
            const size_t i = size_t(y) * size_t(base.width) + size_t(x), at = base.index(x, y);
            if (count[i] == 0 || !is_finite(mean[i])) continue;
            for (int c = 0; c < 3; ++c) base.sums[size_t(c)][at] = mean[i][c];
            base.sums[Level::variance][at] = std::isfinite(variance[i]) ? variance[i] : 0.0f;
            base.sums[Level::weight][at] = 1;
        }
    constexpr size_t kMostLevels = 12;
    while (pyramid.size() < kMostLevels &&
           std::max(pyramid.back().width, pyramid.back().height) > 1)
        pyramid.push_back(halve(pyramid.back()));

    GatheredImage result{std::vector<Rgb>(mean.size()), std::vector<float>(mean.size())};
    parallel_for(field.height, [&](int64_t row) {
        for (int x = 0; x < field.width; ++x) {
            const size_t i = size_t(row) * size_t(field.width) + size_t(x);
            Sym2 s = field.covariance[i];
            for (int attempt = 0; attempt < 6; ++attempt) {
                const float narrow = std::sqrt(std::max(0.0f, covariance::eigen(s).low));
                size_t level = 0;
                while (level + 1 < pyramid.size() && float(2 << level) <= 0.5f * narrow) ++level;
                const float size = float(1 << level);
                // A box of that size has blurred already: (size^2 - 1) / 12 beside single pixels.
                const float blurred = (size * size - 1) / 12;
                const Sym2 rest{(s.xx - blurred) / (size * size), s.xy / (size * size),
                                (s.yy - blurred) / (size * size)};
                const float cx = (float(x) + 0.5f) / size - 0.5f,
                            cy = (float(row) + 0.5f) / size - 0.5f;
                const float total = gaussian_mean(pyramid[level], cx, cy, rest, result.color[i],
                                                  result.variance[i]);
                if (total > 1e-3f) break;
                s = 16.0f * s;
            }
        }
    });
    return result;
}

}  // namespace covtrace
