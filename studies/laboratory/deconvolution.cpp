#include "laboratory/deconvolution.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace covtrace {

namespace {

constexpr double kLeast = 1.0 / 32, kMost = 256;  ///< ends of the grid, in units of the limit
constexpr double kPerOctave = 4;
constexpr int kIterations = 400;

/// The grid: 0 and both signs of a geometric row that keeps clear of the limit itself.
std::vector<double> grid() {
    std::vector<double> points{0};
    for (double x = kLeast * std::exp2(0.5 / kPerOctave); x < kMost;
         x *= std::exp2(1 / kPerOctave)) {
        points.push_back(x);
        points.push_back(-x);
    }
    return points;
}

}  // namespace

double share_beyond(std::span<const float> values, std::span<const float> deviations) {
    const std::vector<double> points = grid();
    const size_t n = values.size(), m = points.size();
    if (n == 0) return 0;
    std::vector<double> likelihood(n * m);
    for (size_t i = 0; i < n; ++i) {
        // Deviations are at least the grid's spacing: no measurement is more exact than the grid.
        const double spacing = std::exp2(0.5 / kPerOctave) - 1;
        const double v = std::clamp<double>(values[i], -kMost, kMost);
        const double d = std::max({double(deviations[i]), 0.5 * kLeast, spacing * std::abs(v)});
        double most = -1e300;
        for (size_t j = 0; j < m; ++j) {
            const double e = (v - points[j]) / d;
            likelihood[i * m + j] = -0.5 * e * e;
            most = std::max(most, likelihood[i * m + j]);
        }
        for (size_t j = 0; j < m; ++j)
            likelihood[i * m + j] = std::exp(likelihood[i * m + j] - most);
    }
    std::vector<double> weight(m, 1.0 / double(m)), next(m);
    for (int iteration = 0; iteration < kIterations; ++iteration) {
        std::fill(next.begin(), next.end(), 0.0);
        for (size_t i = 0; i < n; ++i) {
            double sum = 0;
            for (size_t j = 0; j < m; ++j) sum += weight[j] * likelihood[i * m + j];
            if (!(sum > 0)) continue;
            for (size_t j = 0; j < m; ++j)
                next[j] += weight[j] * likelihood[i * m + j] / (sum * double(n));
        }
        weight.swap(next);
    }
    double beyond = 0, all = 0;
    for (size_t j = 0; j < m; ++j) {
        all += weight[j];
        if (std::abs(points[j]) > 1) beyond += weight[j];
    }
    return all > 0 ? beyond / all : 0;
}

}  // namespace covtrace
