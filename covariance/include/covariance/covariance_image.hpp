// The covariances of a whole image: one 5x5 and its weight per pixel, their mean over neighbours,
// and the spectrum of every pixel's image after the integral over lens and shutter (a Schur
// complement). Allocates: one of the headers for whole images, see renderer.hpp.
#pragma once

#include <algorithm>
#include <limits>
#include <span>
#include <vector>

#include "covariance/sampling.hpp"

namespace covariance {

/// Radiance-weighted mean covariances over (pixel x, pixel y, lens, lens, shutter), row by row.
/// Weight 0: no path of the pixel found light, and the covariance is zero. Where a scene lacks one
/// of the parts of light (in view, or scattered) an image of 0x0 pixels stands for it.
template <std::floating_point T = float>
struct CovarianceImage {
    CovarianceImage(int w, int h)
        : width(w),
          height(h),
          covariance(std::size_t(w) * std::size_t(h)),
          weight(covariance.size(), T(0)) {}

    int width, height;
    std::vector<SymmetricMatrix5<T>> covariance;
    std::vector<T> weight;

    /// Adds a path: the result of `sensor`, weighted by the radiance (one number, say the mean of
    /// the colour) that it adds to the pixel. A path that is not finite or carries nothing is left
    /// out; returns whether it was added. One owner per pixel, in a fixed order, gives fixed bits.
    template <std::floating_point S>
    bool add(int x, int y, const SymmetricMatrix5<S>& sigma, NonDeduced<S> radiance) {
        const SymmetricMatrix5<T> s = cast<T>(sigma);
        const T w = static_cast<T>(radiance);
        if (!(w > 0) || !std::isfinite(w) || !is_finite(s)) return false;
        const std::size_t i = std::size_t(y) * std::size_t(width) + std::size_t(x);
        weight[i] += w;
        const T share = w / weight[i];
        covariance[i] = (1 - share) * covariance[i] + share * s;
        return true;
    }
};

/// The covariances of all light, from those of its two parts: images of one size, or of 0x0.
template <std::floating_point T>
[[nodiscard]] CovarianceImage<T> merge(const CovarianceImage<T>& a, const CovarianceImage<T>& b) {
    if (a.weight.empty() || b.weight.empty()) return a.weight.empty() ? b : a;
    CovarianceImage<T> result = a;
    for (std::size_t i = 0; i < result.weight.size(); ++i) {
        if (!(b.weight[i] > 0)) continue;
        result.weight[i] += b.weight[i];
        const T share = b.weight[i] / result.weight[i];
        result.covariance[i] = (1 - share) * a.covariance[i] + share * b.covariance[i];
    }
    return result;
}

/// Prediction for every pixel: its image's spectrum, and how much its light varies over lens and
/// shutter.
template <std::floating_point T = float>
struct Prediction {
    int width = 0, height = 0;
    std::vector<Sym2<T>> spectrum;  ///< (cycles/pixel)^2, after the integral over lens and shutter
    /// N_int = sqrt(det(S_rr + W_rr) / det W_rr) >= 1: variation over lens and shutter.
    std::vector<T> interior_count;
};

namespace detail {

/// Passes over an image down and up, as a chamfer distance transform does (Borgefors 1986,
/// "Distance transformations in digital images"), and calls `relax(pixel, neighbour, is_diagonal)`.
template <typename Relax>
void sweep_neighbours(int width, int height, const Relax& relax) {
    const auto visit = [&](int x, int y, int dx, int dy) {
        const int px = x + dx, py = y + dy;
        if (px < 0 || py < 0 || px >= width || py >= height) return;
        relax(std::size_t(y) * std::size_t(width) + std::size_t(x),
              std::size_t(py) * std::size_t(width) + std::size_t(px), dx != 0 && dy != 0);
    };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            visit(x, y, -1, 0);
            visit(x, y, 0, -1);
            visit(x, y, -1, -1);
            visit(x, y, 1, -1);
        }
    for (int y = height - 1; y >= 0; --y)
        for (int x = width - 1; x >= 0; --x) {
            visit(x, y, 1, 0);
            visit(x, y, 0, 1);
            visit(x, y, 1, 1);
            visit(x, y, -1, 1);
        }
}

}  // namespace detail

/// Computes one row of `preintegrate`. Rows may run in parallel.
template <std::floating_point T>
void preintegrate_row(const CovarianceImage<T>& image, int y, Prediction<T>& result) {
    const std::size_t begin = std::size_t(y) * std::size_t(image.width);
    for (std::size_t i = begin; i < begin + std::size_t(image.width); ++i) {
        const auto [spectrum, count] = integrate_over_sensor(cast<double>(image.covariance[i]));
        result.spectrum[i] = {T(spectrum.xx), T(spectrum.xy), T(spectrum.yy)};
        result.interior_count[i] = T(count);
    }
}

/// For every pixel the index of a nearest pixel with a weight; its own where no pixel has one. The
/// distance is that of steps to neighbours, 5 long along an axis and 7 diagonally, so that the time
/// is in proportion to the pixels however large the holes.
template <std::floating_point T>
std::vector<std::size_t> nearest_with_weight(std::span<const T> weight, int width, int height) {
    constexpr int far = std::numeric_limits<int>::max() / 2;
    std::vector<int> distance(weight.size(), far);
    std::vector<std::size_t> nearest(weight.size());
    for (std::size_t i = 0; i < nearest.size(); ++i) {
        nearest[i] = i;
        if (weight[i] > 0) distance[i] = 0;
    }
    // Pixels that the pass down cannot reach keep the distance "far" and their own index; the pass
    // up reaches them.
    detail::sweep_neighbours(width, height, [&](std::size_t i, std::size_t j, bool diagonal) {
        const int step = diagonal ? 7 : 5;
        if (distance[j] + step >= distance[i]) return;
        distance[i] = distance[j] + step;
        nearest[i] = nearest[j];
    });
    return nearest;
}

/// Computes one row of `smooth`. Rows may run in parallel.
template <std::floating_point T>
void smooth_row(const CovarianceImage<T>& image, std::span<const std::size_t> nearest, int y,
                CovarianceImage<T>& result) {
    const auto index = [&](int px, int py) {
        return std::size_t(py) * std::size_t(image.width) + std::size_t(px);
    };
    for (int x = 0; x < image.width; ++x) {
        SymmetricMatrix5<T> sum;
        T total = 0;
        for (int py = std::max(0, y - 1); py <= std::min(image.height - 1, y + 1); ++py)
            for (int px = std::max(0, x - 1); px <= std::min(image.width - 1, x + 1); ++px) {
                const std::size_t j = index(px, py);
                sum = sum + image.weight[j] * image.covariance[j];
                total += image.weight[j];
            }
        const std::size_t i = index(x, y);
        result.weight[i] = image.weight[i];
        result.covariance[i] = total > 0 ? (1 / total) * sum : image.covariance[nearest[i]];
    }
}

/// The image averaged by weight over 3x3 pixels: the noise of few paths is larger than what the
/// mean hides. Where none of the nine has a weight, the covariance of a nearest pixel that has one.
/// Weights stay. Where no pixel at all has a weight every covariance is zero.
template <std::floating_point T>
[[nodiscard]] CovarianceImage<T> smooth(const CovarianceImage<T>& image) {
    CovarianceImage<T> result(image.width, image.height);
    const auto nearest = nearest_with_weight<T>(image.weight, image.width, image.height);
    for (int y = 0; y < image.height; ++y) smooth_row<T>(image, nearest, y, result);
    return result;
}

/// Integrates every pixel over lens and shutter, in double.
template <std::floating_point T>
[[nodiscard]] Prediction<T> preintegrate(const CovarianceImage<T>& image) {
    Prediction<T> result{image.width, image.height, std::vector<Sym2<T>>(image.covariance.size()),
                         std::vector<T>(image.covariance.size())};
    for (int y = 0; y < image.height; ++y) preintegrate_row(image, y, result);
    return result;
}

}  // namespace covariance
