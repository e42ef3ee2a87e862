#include "reproduce/comb.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace covtrace::reproduce {

Comb comb_for(const covariance::Sym2<double>& s, double rate) {
    const auto spacing = [rate](double variance) {
        return std::max(1, int(std::lround(1 / (rate * std::sqrt(variance)))));
    };
    return {{spacing(s.xx), spacing(s.yy)}};
}

Grid sampled(const Grid& signal, const Comb& comb) {
    Grid result(signal.width, signal.height);
    const auto [ax, ay] = comb.spacing;
    const int x0 = (signal.width / 2 + comb.beside[0]) % ax,
              y0 = (signal.height / 2 + comb.beside[1]) % ay;
    for (int y = y0; y < signal.height; y += ay)
        for (int x = x0; x < signal.width; x += ax) result.at(x, y) = signal.at(x, y) * ax * ay;
    return result;
}

Grid filtered(const Grid& grid, const covariance::Sym2<double>& s) {
    constexpr double kTwoPiSq = 2 * std::numbers::pi * std::numbers::pi;
    const double height = 2 * std::numbers::pi * std::sqrt(covariance::det(s));
    Grid result(grid.width, grid.height);
    for (int v = 0; v < grid.height; ++v)
        for (int u = 0; u < grid.width; ++u) {
            const double value = grid.at(u, v) * height;
            if (value == 0) continue;
            for (int y = 0; y < grid.height; ++y)
                for (int x = 0; x < grid.width; ++x) {
                    const double dx = x - u, dy = y - v;
                    const double form = s.xx * dx * dx + 2 * s.xy * dx * dy + s.yy * dy * dy;
                    result.at(x, y) += value * std::exp(-kTwoPiSq * form);
                }
        }
    return result;
}

std::vector<std::array<double, 2>> replicas_of(const Comb& comb) {
    constexpr int kTeeth = 3;
    std::vector<std::array<double, 2>> middles;
    for (int j = -kTeeth; j <= kTeeth; ++j)
        for (int i = -kTeeth; i <= kTeeth; ++i)
            if (i != 0 || j != 0)
                middles.push_back({double(i) / comb.spacing[0], double(j) / comb.spacing[1]});
    return middles;
}

double predicted_alias(const Comb& comb, const covariance::Sym2<double>& s) {
    double sum = 0;
    for (const auto& [x, y] : replicas_of(comb))
        sum +=
            std::exp(-0.5 * (s.yy * x * x - 2 * s.xy * x * y + s.xx * y * y) / covariance::det(s));
    return sum;
}

double measured_alias(const Grid& signal, const Comb& comb, const covariance::Sym2<double>& s) {
    constexpr int kPlaces = 4;
    const Grid from_all = filtered(signal, s);
    double all = 0, difference = 0;
    for (const double value : from_all.values) all += value * value;
    for (int j = 0; j < kPlaces; ++j)
        for (int i = 0; i < kPlaces; ++i) {
            Comb moved = comb;
            moved.beside = {i * comb.spacing[0] / kPlaces, j * comb.spacing[1] / kPlaces};
            const Grid from_samples = filtered(sampled(signal, moved), s);
            for (size_t k = 0; k < from_all.values.size(); ++k) {
                const double d = from_samples.values[k] - from_all.values[k];
                difference += d * d / (kPlaces * kPlaces);
            }
        }
    return all > 0 ? difference / all : 0;
}

}  // namespace covtrace::reproduce
