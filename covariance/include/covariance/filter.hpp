// The reconstruction filter that fits a 2x2 spectrum, widened in frequency by c so that it keeps
// the signal:  h(p) = exp(-p^T Q p / 2),  Q = 4 pi^2 c^2 Sigma_2D,  p in pixels.
//
// Gather with it: I = sum h_i l_i / sum h_i over samples within three standard deviations; where
// the number of samples varies from pixel to pixel divide each weight by that number.
#pragma once

#include <cmath>

#include "covariance/sym2.hpp"

namespace covariance {

/// Range of the standard deviations of filters, in pixels.
template <std::floating_point T = double>
struct FilterLimits {
    T s_min = T(0.5);
    T s_max = 15;
};

/// Width factor of filters, c(n) = 2 (n/16)^(1/6) for n samples per pixel on average: the more
/// samples, the narrower.
///
/// c = 2 keeps 88 % of a sinusoid at the edge of the spectrum; a fixed c leaves a bias that more
/// samples never remove.
template <std::floating_point T>
[[nodiscard]] T filter_sharpness(T samples_per_pixel) noexcept {
    return 2 * std::pow(samples_per_pixel / 16, T(1) / 6);
}

/// Quadratic form of a filter: Q = 4 pi^2 c^2 Sigma_2D with its eigenvalues brought into
/// [1/s_max^2, 1/s_min^2].
///
/// Units    spectrum in (cycles/pixel)^2, Q in 1/pixel^2. Errors: none.
template <std::floating_point T>
[[nodiscard]] Sym2<T> filter_quadratic(const Sym2<T>& spectrum, NonDeduced<T> c,
                                       const FilterLimits<NonDeduced<T>>& limits = {}) noexcept {
    return clamp_eigenvalues(four_pi_sq<T> * c * c * spectrum, 1 / (limits.s_max * limits.s_max),
                             1 / (limits.s_min * limits.s_min));
}

/// Quadratic form Q = 2 pi Sigma_2D: the filter A exp(-pi p^T Sigma p) as printed in Belcour 2012,
/// "A Frequency Analysis of Light Transport: From Theory to Implementation", equation 5.7.
///
/// With a true covariance this is c^2 = 1/(2 pi), a kernel 2.5 times wider than c = 1.
template <std::floating_point T>
[[nodiscard]] Sym2<T> thesis_filter_quadratic(
    const Sym2<T>& spectrum, const FilterLimits<NonDeduced<T>>& limits = {}) noexcept {
    return clamp_eigenvalues(2 * pi<T> * spectrum, 1 / (limits.s_max * limits.s_max),
                             1 / (limits.s_min * limits.s_min));
}

/// Covariance of a filter in pixels^2: S_h = Q^-1.
template <std::floating_point T>
[[nodiscard]] constexpr Sym2<T> filter_covariance(const Sym2<T>& quadratic) noexcept {
    return inverse(quadratic);
}

/// Weight of a filter at an offset in pixels: h(p) = exp(-p^T Q p / 2), 1 at the centre.
template <std::floating_point T>
[[nodiscard]] T filter_weight(const Sym2<T>& q, NonDeduced<T> px, NonDeduced<T> py) noexcept {
    return std::exp(-(q.xx * px * px + 2 * q.xy * px * py + q.yy * py * py) / 2);
}

/// Number of samples that a filter effectively averages at N per pixel: 4 pi N sqrt det(S_h).
template <std::floating_point T>
[[nodiscard]] T effective_samples(const Sym2<T>& filter_cov,
                                  NonDeduced<T> samples_per_pixel) noexcept {
    return 4 * pi<T> * samples_per_pixel * std::sqrt(det(filter_cov));
}

/// Size of a filter as one length in pixels: s = det(S_h)^(1/4).
template <std::floating_point T>
[[nodiscard]] T filter_size(const Sym2<T>& filter_cov) noexcept {
    return std::sqrt(std::sqrt(det(filter_cov)));
}

/// A filter scaled to another size, its eigenvalues clamped again: S_h (s'/s)^2.
///
/// For limiting each filter by its sharper neighbours, s'(p) = min over q of s(q) + kappa |p - q|,
/// with kappa = edge_beta / c: what an edge at that distance asks for.
template <std::floating_point T>
[[nodiscard]] Sym2<T> resize_filter(const Sym2<T>& filter_cov, NonDeduced<T> new_size,
                                    const FilterLimits<NonDeduced<T>>& limits = {}) noexcept {
    const T ratio = new_size / filter_size(filter_cov);
    return clamp_eigenvalues(ratio * ratio * filter_cov, limits.s_min * limits.s_min,
                             limits.s_max * limits.s_max);
}

}  // namespace covariance
