// The gather: every pixel is a Gaussian mean of the pixels around it,
//
//   I(p) = sum_i h_p(i - p) m_i / sum_i h_p(i - p)
//
// over means m_i of pixels (not sums: so the local density of samples is divided out). A gather,
// never a splat: no result depends on the order of pixels.
//
// Plain loops, a few nanoseconds per pixel under a filter. The renderer beside this library has a
// gather of its own (src/reconstruction/gather.h), since wide filters cost it more than paths do:
// it reads them from a pyramid with SIMD instructions, the variance and both halves at once.
// Allocates: one of the headers for whole images, see renderer.hpp.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "covariance/filter_field.hpp"

namespace covariance {

namespace detail {

/// Weighted sum of the colours around (x, y), by a Gaussian of the covariance `s` that is cut at
/// three standard deviations, and the sum of the weights: their quotient is the mean.
template <Vec3Like Color, std::floating_point T>
std::pair<Vec3<double>, double> gaussian_mean(std::span<const Color> mean,
                                              std::span<const std::uint32_t> count,
                                              const FilterField<T>& field, int x, int y,
                                              const Sym2<double>& s) {
    const Sym2<double> q = inverse(s);
    constexpr double cut = 9;  // squared standard deviations
    const int reach = int(std::min(std::sqrt(cut * s.yy), double(field.height)));
    Vec3<double> sum;
    double all = 0;
    for (int py = std::max(0, y - reach); py <= std::min(field.height - 1, y + reach); ++py) {
        // The row's chord of the ellipse is q.xx x^2 + 2 q.xy x dy + q.yy dy^2 <= cut.
        const double dy = py - y, middle = x - q.xy * dy / q.xx;
        const double half = std::sqrt(std::max(0.0, (cut - dy * dy / s.yy) / q.xx));
        const int first = int(std::ceil(std::max(middle - half, 0.0)));
        const int last = int(std::floor(std::min(middle + half, field.width - 1.0)));
        for (int px = first; px <= last; ++px) {
            const std::size_t i = std::size_t(py) * std::size_t(field.width) + std::size_t(px);
            const Vec3<double> m = mean[i];
            const Vec3<T> held{T(m.x), T(m.y), T(m.z)};  // infinite beyond the range of T
            const bool is_finite = held.x - held.x + held.y - held.y + held.z - held.z == 0;
            if (count[i] == 0 || !is_finite) continue;
            const double h = filter_weight(q, px - x, dy);
            sum += h * m;
            all += h;
        }
    }
    return {sum, all};
}

}  // namespace detail

/// Gathers an image by its filters.
///
/// Shapes   mean, count: width * height, row by row; colours of any type with members x, y, z
///          (`Vec3<float>` or your own).
/// Errors   none. Pixels without samples (count 0) are left out, and so are means that are not
///          finite in T: a NaN of the renderer is hidden here, not reported. A pixel with nothing
///          to gather from gets filters four times as wide, up to five times over, until it has;
///          one that still has nothing is black.
template <Vec3Like Color, std::floating_point T>
[[nodiscard]] std::vector<Vec3<T>> gather(std::span<const Color> mean,
                                          std::span<const std::uint32_t> count,
                                          const FilterField<T>& field) {
    constexpr double least_weight = 1e-3, four_times_as_wide = 16;
    constexpr int attempts = 6;
    std::vector<Vec3<T>> image(mean.size());
    for (int y = 0; y < field.height; ++y)
        for (int x = 0; x < field.width; ++x) {
            const std::size_t i = std::size_t(y) * std::size_t(field.width) + std::size_t(x);
            const Sym2<T>& filter = field.covariance[i];
            Sym2<double> s{filter.xx, filter.xy, filter.yy};
            for (int k = 0; k < attempts; ++k, s = four_times_as_wide * s) {
                const auto [sum, all] = detail::gaussian_mean(mean, count, field, x, y, s);
                if (all > 0) image[i] = sum / all;
                if (all > least_weight) break;
            }
        }
    return image;
}

/// Gathers an image that is a vector of colours.
template <Vec3Like Color, std::floating_point T>
[[nodiscard]] std::vector<Vec3<T>> gather(const std::vector<Color>& mean,
                                          const std::vector<std::uint32_t>& count,
                                          const FilterField<T>& field) {
    return gather(std::span<const Color>(mean), std::span<const std::uint32_t>(count), field);
}

/// Gathers both parts of the light, each through its filters, and adds them. A part without light
/// may be an empty vector.
template <Vec3Like Color, std::floating_point T>
[[nodiscard]] std::vector<Vec3<T>> gather(const std::vector<Color>& scattered,
                                          const std::vector<Color>& in_view,
                                          const std::vector<std::uint32_t>& count,
                                          const PartFilters<T>& filters) {
    if (in_view.empty()) return gather(scattered, count, filters.scattered);
    if (scattered.empty()) return gather(in_view, count, filters.in_view);
    std::vector<Vec3<T>> image = gather(scattered, count, filters.scattered);
    const std::vector<Vec3<T>> bright = gather(in_view, count, filters.in_view);
    for (std::size_t i = 0; i < image.size(); ++i) image[i] += bright[i];
    return image;
}

}  // namespace covariance
