// Number of samples that a pixel needs. Belcour 2012, "A Frequency Analysis of Light Transport:
// From Theory to Implementation", section 5.1, has the count N = k sqrt(det Sigma) per unit of
// pixel, lens and shutter; it vanishes as soon as one axis is constant. With the windowed matrix
// Sigma + W (preintegrate.hpp) it splits, r the axes of lens and shutter:
//
//   sqrt det(Sigma + W) = sqrt det(Sigma_2D) * sqrt det(Sigma_rr + W_rr)
//   N_int = sqrt( det(Sigma_rr + W_rr) / det W_rr ) >= 1,      N = k_img sqrt det(Sigma_2D) N_int
//
// All matrices are in sensor coordinates: cycles per pixel, lens radius, shutter interval.
#pragma once

#include <cmath>
#include <numbers>

#include "covariance/preintegrate.hpp"

namespace covariance {

/// Spectrum and count of a pixel, the result of eliminating lens and shutter from S + W once.
template <std::floating_point T = double>
struct SensorIntegral {
    Sym2<T> spectrum;   ///< `preintegrate()`
    T integration = 1;  ///< `integration_count()`
};

/// Integrates over lens and shutter: spectrum and count together, at the cost of one.
///
/// Shapes   s, window: sensor coordinates, `sensor_window()`.
/// Errors   none; limits are those of `preintegrate` and `integration_count`.
template <std::floating_point T>
[[nodiscard]] SensorIntegral<T> integrate_over_sensor(
    const SymmetricMatrix5<T>& s,
    const SymmetricMatrix5<NonDeduced<T>>& window = sensor_window<T>()) noexcept {
    const detail::Elimination<T> e = detail::eliminate_uvt(s, window);
    return {e.schur, e.windowed ? std::sqrt(e.ratio) : T(1)};
}

/// Number N_int of samples for the integral over lens and shutter at one point of the image.
///
/// kappa N_int samples give a relative standard deviation of at most 1/sqrt(kappa), for Gaussians.
/// Post     at least 1, and 1 where nothing varies over lens and shutter.
/// Errors   none; without a window (W_rr singular) the result is 1.
template <std::floating_point T>
[[nodiscard]] T integration_count(
    const SymmetricMatrix5<T>& s,
    const SymmetricMatrix5<NonDeduced<T>>& window = sensor_window<T>()) noexcept {
    return integrate_over_sensor(s, window).integration;
}

/// Density sqrt det of a 2x2 spectrum: samples per pixel of its image, up to the factor k_img.
template <std::floating_point T>
[[nodiscard]] T image_density(const Sym2<T>& spectrum) noexcept {
    const T d = det(spectrum);
    return d < 0 ? T(0) : std::sqrt(d);
}

/// Factor k_img = pi c^2 kappa: with it a filter of width factor c averages kappa N_int samples.
template <std::floating_point T>
[[nodiscard]] constexpr T image_factor(T c, NonDeduced<T> kappa) noexcept {
    return pi<T> * c * c * kappa;
}

/// Factor k = m^5 of N = k sqrt(det Sigma) for a lattice of spacing 1/(m sigma_f) per axis, whose
/// mean is wrong by 2 exp(-m^2/2): 8.8 % for m = 2.5, 2.2 % for m = 3.
template <std::floating_point T>
[[nodiscard]] constexpr T lattice_factor(T m) noexcept {
    return m * m * m * m * m;
}

/// The spectrum limited to what filters of standard deviation s_min to s_max pixels can use:
/// eigenvalues in [1/(2 pi c s_max)^2, 1/(2 pi c s_min)^2]. Do this before taking a determinant.
template <std::floating_point T>
[[nodiscard]] Sym2<T> limit_spectrum(const Sym2<T>& spectrum, NonDeduced<T> c, NonDeduced<T> s_min,
                                     NonDeduced<T> s_max) noexcept {
    const T scale = 1 / (four_pi_sq<T> * c * c);
    return clamp_eigenvalues(spectrum, scale / (s_max * s_max), scale / (s_min * s_min));
}

/// A predicted number of samples per pixel and its two factors.
template <std::floating_point T = double>
struct SampleCount {
    T total = 0;        ///< image * integration
    T image = 0;        ///< k_img sqrt det Sigma_2D
    T integration = 1;  ///< N_int
};

/// Predicted samples of one pixel, N = k_img sqrt det(Sigma_2D) N_int, without any clamp.
template <std::floating_point T>
[[nodiscard]] SampleCount<T> sample_count(const SymmetricMatrix5<T>& s,
                                          const SymmetricMatrix5<NonDeduced<T>>& window,
                                          NonDeduced<T> k_img) noexcept {
    const auto [spectrum, integration] = integrate_over_sensor(s, window);
    const T image = k_img * image_density(spectrum);
    return {image * integration, image, integration};
}

/// Density g = sqrt det(Sigma_2D) N_int of Belcour 2012, section 5.1; counts are budget * g /
/// mean(g), clamped. Its long tail takes the budget from sharp regions.
template <std::floating_point T>
[[nodiscard]] T thesis_density(const Sym2<T>& spectrum, NonDeduced<T> integration) noexcept {
    return image_density(spectrum) * integration;
}

/// Count N of Belcour 2012, section 5.1, for k = 1: sqrt det(S + W) per unit hypercube, which is
/// one pixel, the whole aperture and the whole shutter interval. So k times this is a count per
/// pixel; for a lattice k is `lattice_factor()`.
///
/// An aperture of unit area has the radius 1/sqrt(pi): lengths in radii shrink by sqrt(pi) on two
/// axes, and sqrt det(S + W), of cycles per radius, grows by pi. With `sensor_window()` W has pi
/// sqrt(det W_rr) = sqrt(3)/pi^2. The windows stand for the "small quantities" that Belcour adds to
/// the diagonal lest one constant axis make the determinant vanish.
template <std::floating_point T>
[[nodiscard]] T hypercube_density(const Sym2<T>& spectrum, NonDeduced<T> integration) noexcept {
    return std::numbers::sqrt3_v<T> / (pi<T> * pi<T>)*thesis_density(spectrum, integration);
}

/// Whole count of one pixel by Belcour 2012, section 5.1: clamp(round(N), n_min, n_max). A NaN
/// counts as n_max.
template <std::floating_point T>
[[nodiscard]] T thesis_count(T n, NonDeduced<T> n_min, NonDeduced<T> n_max) noexcept {
    return n < n_max ? std::max(std::round(n), n_min) : n_max;
}

/// The tempered density sqrt( sqrt det(Sigma_2D) min(N_int, 4) ), without the long tail of N_int.
template <std::floating_point T>
[[nodiscard]] T tempered_density(const Sym2<T>& spectrum, NonDeduced<T> integration) noexcept {
    return std::sqrt(image_density(spectrum) * std::min(integration, T(4)));
}

/// The density for a pixel whose standard deviation is known: sigma det(Sigma_2D)^(1/4) / radiance.
/// Pre: radiance above 0.
template <std::floating_point T>
[[nodiscard]] T variance_density(T standard_deviation, const Sym2<NonDeduced<T>>& spectrum,
                                 NonDeduced<T> radiance) noexcept {
    return standard_deviation * std::sqrt(image_density(spectrum)) / radiance;
}

/// Samples of one pixel out of an average budget: budget ((1 - even) g / mean_g + even), with the
/// share `even` going to all pixels alike. Where all densities are zero every pixel gets the
/// budget.
template <std::floating_point T>
[[nodiscard]] constexpr T share_of_budget(T density, NonDeduced<T> mean_density,
                                          NonDeduced<T> budget,
                                          NonDeduced<T> even = T(0.1)) noexcept {
    return mean_density > 0 ? budget * ((1 - even) * density / mean_density + even) : budget;
}

}  // namespace covariance
