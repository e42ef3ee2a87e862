#include "planner/agreement.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/vec.h"

namespace covtrace {

namespace {

/// Deviations of the Gaussians that part the bands, pixels. The densities are means over 1.5
/// pixels already.
constexpr std::array<float, 4> kWidths{3, 6, 12, 24};

double mean(const Plane& p) {
    double sum = 0;
    for (float v : p.values) sum += double(v);
    return p.size() > 0 ? sum / double(p.size()) : 0;
}

/// The roots of a density, their Gaussian means from the narrowest on, and last the mean of all.
std::vector<Plane> smoothed_roots(const Plane& density) {
    std::vector<Plane> levels{density};
    for (float& v : levels[0].values) v = std::sqrt(v);
    for (float width : kWidths) levels.push_back(gaussian_blur(levels[0], width));
    levels.emplace_back(density.width, density.height, float(mean(levels[0])));
    return levels;
}

/// The correlation of both densities' bands, a[k] - a[k + 1] and likewise of b; 1 where one of them
/// is flat.
double correlation(const std::vector<Plane>& a, const std::vector<Plane>& b, size_t k) {
    double squares_a = 0, squares_b = 0, products = 0;
    for (size_t i = 0; i < a[k].size(); ++i) {
        const double of_a = double(a[k][i] - a[k + 1][i]), of_b = double(b[k][i] - b[k + 1][i]);
        squares_a += sqr(of_a);
        squares_b += sqr(of_b);
        products += of_a * of_b;
    }
    const double squares = squares_a * squares_b;
    return squares > 0 ? products / std::sqrt(squares) : 1;
}

/// The density whose root has the share keep[k] of band k, with mean 1.
Plane with_bands(const std::vector<Plane>& levels, const std::vector<float>& keep) {
    Plane density = levels.back();
    for (size_t i = 0; i < density.size(); ++i) {
        float root = density[i];
        for (size_t k = 0; k < keep.size(); ++k)
            root += keep[k] * (levels[k][i] - levels[k + 1][i]);
        density[i] = sqr(root);
    }
    const double scale = mean(density);
    for (float& v : density.values) v = scale > 0 ? float(double(v) / scale) : 1;
    return density;
}

}  // namespace

void keep_what_agrees(std::array<Plane, 2>& density) {
    const std::array levels{smoothed_roots(density[0]), smoothed_roots(density[1])};
    std::vector<float> keep(kWidths.size() + 1);
    double most = 1;
    for (size_t k = keep.size(); k-- > 0;) {
        most = std::clamp(correlation(levels[0], levels[1], k), 0.0, most);
        keep[k] = float(most);
    }
    for (size_t half = 0; half < 2; ++half) density[half] = with_bands(levels[half], keep);
}

}  // namespace covtrace
