#include "bsdf/bilinear_density.h"

#include <algorithm>
#include <cmath>

namespace covtrace {

namespace {

/// Where in [0, 1] the integral of a line from `a` to `b` has grown to `area`, at most (a + b) / 2.
float inverse_of_line(float area, float a, float b) {
    const float sum = a + b;
    if (!(sum > 0)) return 0;
    if (std::abs(a - b) < 1e-4f * sum) return clamp01(2 * area / sum);
    // a t + (b - a) t^2 / 2 = area, by the form without cancellation
    const float root = std::sqrt(std::max(0.0f, a * a + 2 * area * (b - a)));
    return clamp01(2 * area / (a + root));
}

/// Number of the last of `count` - 1 intervals that begins at or below `value`.
template <typename At>
size_t interval(size_t count, float value, const At& at) {
    size_t low = 0, high = count - 1;
    while (high - low > 1) {
        const size_t middle = (low + high) / 2;
        (at(middle) <= value ? low : high) = middle;
    }
    return low;
}

/// The cell that a place lies in and the rest of the way to its other side.
struct Cell {
    size_t index = 0;
    float rest = 0;
};
Cell cell_of(float place, size_t nodes) {
    const float x = clamp01(place) * float(nodes - 1);
    const size_t i = std::min(size_t(x), nodes - 2);
    return {i, x - float(i)};
}

}  // namespace

BilinearDensity::BilinearDensity(int width, int height, std::span<const float> values)
    : width_(size_t(width)), height_(size_t(height)), nodes_(values.begin(), values.end()) {
    const size_t size = width_ * height_, tables = nodes_.size() / size;
    along_.resize(nodes_.size());
    up_.resize(tables * height_);
    for (size_t table = 0; table < tables; ++table) {
        float* nodes = &nodes_[table * size];
        double total = 0;
        for (size_t y = 0; y + 1 < height_; ++y)
            for (size_t x = 0; x + 1 < width_; ++x) {
                const float* n = nodes + y * width_ + x;
                total += 0.25 * (double(n[0]) + n[1] + n[width_] + n[width_ + 1]);
            }
        if (!(total > 0)) {
            std::fill(nodes, nodes + size, 1.0f);
            total = double((width_ - 1) * (height_ - 1));
        }
        for (size_t i = 0; i < size; ++i) nodes[i] = float(nodes[i] / total);
        for (size_t y = 0; y < height_; ++y) {
            double sum = 0;
            for (size_t x = 1; x < width_; ++x) {
                const size_t i = table * size + y * width_ + x;
                sum += 0.5 * (double(nodes_[i - 1]) + nodes_[i]);
                along_[i] = float(sum);
            }
        }
        double sum = 0;
        for (size_t y = 1; y < height_; ++y) {
            const size_t last = table * size + y * width_ + width_ - 1;
            sum += 0.5 * (double(along_[last - width_]) + along_[last]);
            up_[table * height_ + y] = float(sum);
        }
    }
}

float BilinearDensity::mix(const std::vector<float>& values, size_t size, size_t i,
                           const TableWeights& weights) {
    float sum = 0;
    for (int k = 0; k < weights.count; ++k)
        sum += weights.weight[size_t(k)] * values[weights.table[size_t(k)] * size + i];
    return sum;
}

std::array<float, 4> BilinearDensity::corners(size_t x, size_t y, const TableWeights& w) const {
    const size_t size = width_ * height_, i = y * width_ + x;
    return {mix(nodes_, size, i, w), mix(nodes_, size, i + 1, w), mix(nodes_, size, i + width_, w),
            mix(nodes_, size, i + width_ + 1, w)};
}

float BilinearDensity::along_row(size_t x, size_t y, const TableWeights& weights) const {
    return mix(along_, width_ * height_, y * width_ + x, weights);
}

float BilinearDensity::row_total(size_t y, const TableWeights& weights) const {
    return along_row(width_ - 1, y, weights);
}

BilinearDensity::Sample BilinearDensity::sample(Vec2 u, const TableWeights& weights) const {
    const auto below = [&](size_t y) { return mix(up_, height_, y, weights); };
    const size_t y = interval(height_, u.y, below);
    const float r0 = row_total(y, weights), r1 = row_total(y + 1, weights);
    const float v = inverse_of_line(u.y - below(y), r0, r1);

    const auto before = [&](size_t x) {
        return (1 - v) * along_row(x, y, weights) + v * along_row(x, y + 1, weights);
    };
    const float ahead = u.x * before(width_ - 1);
    const size_t x = interval(width_, ahead, before);
    const std::array<float, 4> c = corners(x, y, weights);
    const float left = (1 - v) * c[0] + v * c[2], right = (1 - v) * c[1] + v * c[3];
    const float h = inverse_of_line(ahead - before(x), left, right);
    const auto cells_x = float(width_ - 1), cells_y = float(height_ - 1);
    return {{(float(x) + h) / cells_x, (float(y) + v) / cells_y},
            ((1 - h) * left + h * right) * cells_x * cells_y};
}

BilinearDensity::Sample BilinearDensity::invert(Vec2 place, const TableWeights& weights) const {
    const Cell x = cell_of(place.x, width_), y = cell_of(place.y, height_);
    const std::array<float, 4> c = corners(x.index, y.index, weights);
    const float left = (1 - y.rest) * c[0] + y.rest * c[2],
                right = (1 - y.rest) * c[1] + y.rest * c[3];
    const auto before = [&](size_t i) {
        return (1 - y.rest) * along_row(i, y.index, weights) +
               y.rest * along_row(i, y.index + 1, weights);
    };
    const float row = before(width_ - 1);
    const float ahead = before(x.index) + x.rest * (left + 0.5f * x.rest * (right - left));
    const float r0 = row_total(y.index, weights), r1 = row_total(y.index + 1, weights);
    return {
        {row > 0 ? clamp01(ahead / row) : 0,
         clamp01(mix(up_, height_, y.index, weights) + y.rest * (r0 + 0.5f * y.rest * (r1 - r0)))},
        ((1 - x.rest) * left + x.rest * right) * float(width_ - 1) * float(height_ - 1)};
}

float BilinearDensity::pdf(Vec2 place, const TableWeights& weights) const {
    const Cell x = cell_of(place.x, width_), y = cell_of(place.y, height_);
    const std::array<float, 4> c = corners(x.index, y.index, weights);
    return ((1 - y.rest) * ((1 - x.rest) * c[0] + x.rest * c[1]) +
            y.rest * ((1 - x.rest) * c[2] + x.rest * c[3])) *
           float(width_ - 1) * float(height_ - 1);
}

}  // namespace covtrace
