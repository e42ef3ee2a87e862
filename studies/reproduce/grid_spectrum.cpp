#include "reproduce/grid_spectrum.h"

#include <cmath>
#include <numbers>

namespace covtrace::reproduce {

namespace {

using Complex = std::complex<double>;

/// The factors exp(-2 pi i k/n) for k = 0 … n-1.
std::vector<Complex> roots_of_unity(int n) {
    std::vector<Complex> roots;
    for (int k = 0; k < n; ++k) roots.push_back(std::polar(1.0, -2 * std::numbers::pi * k / n));
    return roots;
}

/// Transforms `count` rows of `length` values and transposes them: doing so twice transforms both
/// axes. The frequency 0 comes to length/2.
std::vector<Complex> transformed_rows(const std::vector<Complex>& rows, int length, int count) {
    const std::vector<Complex> roots = roots_of_unity(length);
    std::vector<Complex> result(rows.size());
    for (int row = 0; row < count; ++row)
        for (int k = 0; k < length; ++k) {
            const int frequency = (k - length / 2 + length) % length;
            Complex sum = 0;
            for (int n = 0; n < length; ++n)
                sum += rows[size_t(row) * size_t(length) + size_t(n)] *
                       roots[size_t(int64_t(frequency) * n % length)];
            result[size_t(k) * size_t(count) + size_t(row)] = sum;
        }
    return result;
}

}  // namespace

GridSpectrum::GridSpectrum(const Grid& grid)
    : width_(grid.width), height_(grid.height), values_(grid.values.begin(), grid.values.end()) {
    values_ = transformed_rows(values_, width_, height_);
    values_ = transformed_rows(values_, height_, width_);
}

Grid windowed(const Grid& grid, std::array<double, 2> deviations) {
    Grid result(grid.width, grid.height);
    const auto weight = [](int at, int size, double deviation) {
        const double d = (at + 0.5 - 0.5 * size) / deviation;
        return std::exp(-0.5 * d * d);
    };
    for (int y = 0; y < grid.height; ++y)
        for (int x = 0; x < grid.width; ++x)
            result.at(x, y) = grid.at(x, y) * weight(x, grid.width, deviations[0]) *
                              weight(y, grid.height, deviations[1]);
    return result;
}

double window_variance(double deviation) {
    const double angular = 2 * std::numbers::pi * deviation;
    return 1 / (angular * angular);
}

Grid padded(const Grid& grid, int width, int height) {
    Grid large(width, height);
    const int x0 = (width - grid.width) / 2, y0 = (height - grid.height) / 2;
    for (int y = 0; y < grid.height; ++y)
        for (int x = 0; x < grid.width; ++x) large.at(x0 + x, y0 + y) = grid.at(x, y);
    return large;
}

}  // namespace covtrace::reproduce
