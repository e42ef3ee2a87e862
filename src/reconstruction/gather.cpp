#include "reconstruction/gather.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace covtrace {

namespace {

using Sym2 = covariance::Sym2<float>;

/// One level of the pyramid: sums over 2^level x 2^level pixels.
struct Level {
    int width = 0, height = 0;
    struct Cell {
        Rgb sum;
        float variance = 0;  // of the sum's luminance
        float weight = 0;    // how many pixels had samples
    };
    std::vector<Cell> cells;
};

Level halve(const Level& fine) {
    Level c;
    c.width = (fine.width + 1) / 2;
    c.height = (fine.height + 1) / 2;
    c.cells.resize(size_t(c.width) * size_t(c.height));
    parallel_for(c.height, [&](int64_t row) {
        const int y = int(row);
        for (int x = 0; x < c.width; ++x) {
            Level::Cell& cell = c.cells[size_t(y) * size_t(c.width) + size_t(x)];
            for (int fy = 2 * y; fy < std::min(2 * y + 2, fine.height); ++fy)
                for (int fx = 2 * x; fx < std::min(2 * x + 2, fine.width); ++fx) {
                    const Level::Cell& f = fine.cells[size_t(fy) * size_t(fine.width) + size_t(fx)];
                    cell.sum += f.sum;
                    cell.variance += f.variance;
                    cell.weight += f.weight;
                }
        }
    });
    return c;
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
    Rgb sum;
    float squares = 0, total = 0;
    for (int y = y0; y <= y1; ++y) {
        // The row's chord of the ellipse: qxx x^2 + 2 qxy x dy + qyy dy^2 <= cut.
        const float dy = float(y) - cy;
        const float centre = -qxy * dy / qxx;
        const float rest = kCut - dy * dy / s.yy;
        const float half = std::sqrt(std::max(0.0f, rest / qxx));
        const int x0 = std::max(0, int(std::ceil(cx + centre - half)));
        const int x1 = std::min(level.width - 1, int(std::floor(cx + centre + half)));
        const size_t row = size_t(y) * size_t(level.width);
        for (int x = x0; x <= x1; ++x) {
            const Level::Cell& cell = level.cells[row + size_t(x)];
            if (cell.weight == 0) continue;
            const float dx = float(x) - cx;
            const float h = std::exp(-0.5f * (qxx * dx * dx + 2 * qxy * dx * dy + qyy * dy * dy));
            sum += h * cell.sum;
            squares += h * h * cell.variance;
            total += h * cell.weight;
        }
    }
    if (total > 0) {
        mean = sum / total;
        variance = squares / (total * total);
    }
    return total;
}

}  // namespace

GatheredImage gather(std::span<const Rgb> mean, std::span<const float> variance,
                     std::span<const uint32_t> count, const FilterField& field) {
    std::vector<Level> pyramid(1);
    Level& base = pyramid[0];
    base.width = field.width;
    base.height = field.height;
    base.cells.resize(mean.size());
    for (size_t i = 0; i < mean.size(); ++i) {
        if (count[i] > 0 && is_finite(mean[i]))
            base.cells[i] = {mean[i], std::isfinite(variance[i]) ? variance[i] : 0.0f, 1.0f};
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
