#include "shading/scalar_field.h"

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

/// Where a doubled field reads: two neighbouring cells and the second one's weight.
struct Between {
    int first = 0, second = 0;
    float weight = 0;
};
Between between(int i, int size, int half_size, bool repeats) {
    if (size == half_size) return {i, i, 0};
    const int cell = i % 2 == 0 ? i / 2 - 1 : i / 2;
    return {ScalarField::wrapped(cell, half_size, repeats),
            ScalarField::wrapped(cell + 1, half_size, repeats), i % 2 == 0 ? 0.75f : 0.25f};
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

ScalarField smooth(const ScalarField& f, const GaussianWindow& window) {
    const int r = window.radius;
    ScalarField along_rows = f.like_this(), result = f.like_this();
    for_each_row(f.height, [&](int y) {
        std::vector<float> padded(size_t(f.width + 2 * r));
        const float* source = f.row(y);
        for (int x = -r; x < f.width + r; ++x) padded[size_t(x + r)] = source[f.column_index(x)];
        for (int i = 0; i <= 2 * r; ++i)
            add_scaled(along_rows.row(y), padded.data() + i, window.weights[size_t(i)], f.width);
    });
    for_each_row(f.height, [&](int y) {
        for (int i = -r; i <= r; ++i)
            add_scaled(result.row(y), along_rows.row(f.row_index(y + i)),
                       window.weights[size_t(i + r)], f.width);
    });
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

ScalarField doubled(const ScalarField& f, int width, int height) {
    ScalarField result(width, height, f.repeat_x, f.repeat_y);
    std::vector<Between> columns;
    for (int x = 0; x < width; ++x) columns.push_back(between(x, width, f.width, f.repeat_x));
    for_each_row(height, [&](int y) {
        const Between rows = between(y, height, f.height, f.repeat_y);
        const float *a = f.row(rows.first), *b = f.row(rows.second);
        float* target = result.row(y);
        for (int x = 0; x < width; ++x) {
            const Between& c = columns[size_t(x)];
            const float upper = a[c.first] + c.weight * (a[c.second] - a[c.first]);
            const float lower = b[c.first] + c.weight * (b[c.second] - b[c.first]);
            target[x] = upper + rows.weight * (lower - upper);
        }
    });
    return result;
}

ScalarField box_reduced(const ScalarField& f, int factor) {
    ScalarField result((f.width + factor - 1) / factor, (f.height + factor - 1) / factor,
                       f.repeat_x, f.repeat_y);
    for_each_row(result.height, [&](int y) {
        const int rows = std::min(factor, f.height - y * factor);
        for (int x = 0; x < result.width; ++x) {
            const int columns = std::min(factor, f.width - x * factor);
            double sum = 0;
            for (int j = 0; j < rows; ++j)
                for (int i = 0; i < columns; ++i)
                    sum += double(f.row(y * factor + j)[x * factor + i]);
            result.row(y)[x] = float(sum / (rows * columns));
        }
    });
    return result;
}

}  // namespace covtrace
