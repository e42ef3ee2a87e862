#include "texture/scalar_field.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"

namespace covtrace {
namespace {

constexpr int kRowsPerTask = 16;

/// Calls body(y) for all rows. Rows are independent, so that the result depends on no schedule.
template <typename Body>
void for_each_row(int height, const Body& body) {
    parallel_for((height + kRowsPerTask - 1) / kRowsPerTask, [&](int64_t task) {
        const int first = int(task) * kRowsPerTask;
        for (int y = first; y < std::min(height, first + kRowsPerTask); ++y) body(y);
    });
}

void add_scaled(float* sum, const float* values, float weight, int count) {
    for (int i = 0; i < count; ++i) sum[i] += weight * values[i];
}

/// sums[x] = sum over i of weights[i] values[x + i stride].
void weighted_sums(const float* values, int stride, const std::vector<float>& weights, float* sums,
                   int count) {
    constexpr int kBlock = 32;  // sums that stay in registers
    int x = 0;
    for (; x + kBlock <= count; x += kBlock) {
        std::array<float, kBlock> block{};
        const float* from = values + x;
        for (const float w : weights) {
            for (size_t k = 0; k < kBlock; ++k) block[k] += w * from[k];
            from += stride;
        }
        std::copy(block.begin(), block.end(), sums + x);
    }
    for (; x < count; ++x) {
        float sum = 0;
        const float* from = values + x;
        for (const float w : weights) {
            sum += w * *from;
            from += stride;
        }
        sums[x] = sum;
    }
}

}  // namespace

GaussianWindow::GaussianWindow(float standard_deviation)
    : radius(int(std::ceil(3 * standard_deviation))), weights(size_t(2 * radius + 1)) {
    double sum = 0, second_moment = 0;
    for (int i = -radius; i <= radius; ++i) {
        const float w = std::exp(-0.5f * float(i * i) / (standard_deviation * standard_deviation));
        weights[size_t(i + radius)] = w;
        sum += w;
        second_moment += double(w) * i * i;
    }
    for (float& w : weights) w = float(w / sum);
    variance = float(second_moment / sum);
}

ScalarField smooth_inside(const ScalarField& f, const GaussianWindow& window) {
    const int r = window.radius;
    ScalarField along_rows(f.width - 2 * r, f.height, false, false);
    for (int y = 0; y < f.height; ++y)
        weighted_sums(f.row(y), 1, window.weights, along_rows.row(y), along_rows.width);
    ScalarField result(along_rows.width, f.height - 2 * r, false, false);
    for (int y = 0; y < result.height; ++y)
        weighted_sums(along_rows.row(y), along_rows.width, window.weights, result.row(y),
                      result.width);
    return result;
}

ScalarField halved(const ScalarField& f) {
    constexpr std::array<float, 4> kBinomial{0.125f, 0.375f, 0.375f, 0.125f};
    ScalarField result((f.width + 1) / 2, (f.height + 1) / 2, f.repeat_x, f.repeat_y);
    for_each_row(result.height, [&](int y) {
        std::vector<float> column(size_t(f.width));
        for (int j = 0; j < 4; ++j)
            add_scaled(column.data(), f.row(f.row_index(2 * y - 1 + j)), kBinomial[size_t(j)],
                       f.width);
        float* target = result.row(y);
        for (int x = 0; x < result.width; ++x)
            for (int i = 0; i < 4; ++i)
                target[x] += kBinomial[size_t(i)] * column[size_t(f.column_index(2 * x - 1 + i))];
    });
    return result;
}

Between between(int i, int size, int half_size, bool repeats) {
    if (size == half_size) return {i, i, 0};
    const int cell = i % 2 == 0 ? i / 2 - 1 : i / 2;
    return {ScalarField::wrapped(cell, half_size, repeats),
            ScalarField::wrapped(cell + 1, half_size, repeats), i % 2 == 0 ? 0.75f : 0.25f};
}

ScalarField box_reduced(const std::function<float(size_t)>& cell, int width, int height,
                        bool repeats_x, bool repeats_y, int factor) {
    ScalarField result((width + factor - 1) / factor, (height + factor - 1) / factor, repeats_x,
                       repeats_y);
    for_each_row(result.height, [&](int y) {
        const int rows = std::min(factor, height - y * factor);
        for (int x = 0; x < result.width; ++x) {
            const int columns = std::min(factor, width - x * factor);
            double sum = 0;
            for (int j = 0; j < rows; ++j)
                for (int i = 0; i < columns; ++i)
                    sum += double(
                        cell(size_t(y * factor + j) * size_t(width) + size_t(x * factor + i)));
            result.row(y)[x] = float(sum / (rows * columns));
        }
    });
    return result;
}

}  // namespace covtrace
