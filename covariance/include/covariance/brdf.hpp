// Lobes and windows of surface scattering, as 2x2 covariances in 1/rad^2: reflection.hpp and
// refraction.hpp convolve the light with lobes and multiply it by windows.
//
// All lobes have positive spectra, for which Sigma = -Hess f / (4 pi^2 f) at the peak.
#pragma once

#include <cmath>

#include "covariance/surface.hpp"

namespace covariance {

/// Slope distribution of a Beckmann surface: diag(2/ax^2, 2/ay^2) / (4 pi^2), axes t1, t2.
template <std::floating_point T>
[[nodiscard]] constexpr Sym2<T> micro_beckmann(T alpha_x, NonDeduced<T> alpha_y) noexcept {
    return Sym2<T>::diagonal(2 / (alpha_x * alpha_x * four_pi_sq<T>),
                             2 / (alpha_y * alpha_y * four_pi_sq<T>));
}

/// Slope distribution of a GGX surface: diag(4/ax^2, 4/ay^2) / (4 pi^2), axes t1, t2.
template <std::floating_point T>
[[nodiscard]] constexpr Sym2<T> micro_ggx(T alpha_x, NonDeduced<T> alpha_y) noexcept {
    return 2 * micro_beckmann(alpha_x, alpha_y);
}

/// Slope distribution of a Blinn-Phong surface of exponent e: (e, e) / (4 pi^2).
template <std::floating_point T>
[[nodiscard]] constexpr Sym2<T> micro_blinn(T exponent) noexcept {
    return Sym2<T>::diagonal(exponent / four_pi_sq<T>, exponent / four_pi_sq<T>);
}

/// A Phong lobe cos^e about the mirror direction: C = e/(4 pi^2) I, in outgoing slopes. Source:
/// Belcour 2012, "A Frequency Analysis of Light Transport: From Theory to Implementation", whose B
/// is the inverse, 4 pi^2/e.
template <std::floating_point T>
[[nodiscard]] constexpr Sym2<T> phong_cov(T exponent) noexcept {
    return micro_blinn(exponent);
}

/// Lobe of a fuzzy mirror, which adds to the unit mirror direction a vector drawn evenly from the
/// ball of radius `fuzz`: (4 pi^2 fuzz^2/5)^-1 I, in outgoing slopes, from the lobe's second
/// moments (a ball has no spectrum without negative parts). Vectors drawn on the sphere instead of
/// in the ball have the variance fuzz^2/3: give fuzz * sqrt(5/3).
///
/// Units    fuzz without unit, small beside 1; 0 gives infinity, use `reflect_specular`.
template <std::floating_point T>
[[nodiscard]] constexpr Sym2<T> fuzz_cov(T fuzz) noexcept {
    const T c = 5 / (four_pi_sq<T> * fuzz * fuzz);
    return Sym2<T>::diagonal(c, c);
}

/// Lobe of a microfacet reflection in outgoing slopes: C = P Cm P^T / (4 (h.Zo)^2).
///
/// Shapes   micro: slope covariance in the tangent basis; p_out = [Xo.T1 Xo.T2; Yo.T1 Yo.T2].
/// Frames   for the mirror pair T1, T2 of the surface and the cosine of incidence; off the mirror
///          direction T1, T2 turned from n to the half vector h, and h.Zo.
/// Aligned: diag(Cm11/4, Cm22/(4 cos^2)), a lobe that narrows across the plane towards grazing.
template <std::floating_point T>
[[nodiscard]] constexpr Sym2<T> reflection_cov(const Sym2<T>& micro,
                                               const Mat2<NonDeduced<T>>& p_out,
                                               NonDeduced<T> cos_h) noexcept {
    return (1 / (4 * cos_h * cos_h)) * congruence(micro, transpose(p_out));
}

/// Lobe of a microfacet refraction in outgoing slopes: C = (n2/Gamma)^2 P Cm P^T with
/// Gamma = n2 cos_t - n1 cos_i.
///
/// Units    refractive indices n1 before, n2 after; both cosines positive.
/// Errors   infinite or NaN where Gamma is 0 (equal indices, a perfectly sharp lobe).
template <std::floating_point T>
[[nodiscard]] constexpr Sym2<T> refraction_cov(const Sym2<T>& micro,
                                               const Mat2<NonDeduced<T>>& p_out,
                                               NonDeduced<T> cos_i, NonDeduced<T> cos_t,
                                               NonDeduced<T> n1, NonDeduced<T> n2) noexcept {
    const T ratio = n2 / (n2 * cos_t - n1 * cos_i);
    return (ratio * ratio) * congruence(micro, transpose(p_out));
}

/// A lobe of the shape (1 + r^2/a^2)^-2, which falls off more slowly than the Gaussian of its peak,
/// as light of the angular covariance `light` finds it: C' with C'^-1 = C^-1 + (C + light)^-1.
///
/// Light that smooths the lobe by a variance S far below the lobe's own widens its peak by 2 S,
/// where a Gaussian's would widen by S (from the Taylor series of the lobe); for S as large as the
/// lobe the excess stays behind. Sharp light leaves C as it is, even light halves it. Within 2 % of
/// the exact bandwidth up to S equal to the lobe's, and above it (never below) from there on.
/// Shapes   both in the same axes; units 1/rad^2; C positive definite.
template <std::floating_point T>
[[nodiscard]] constexpr Sym2<T> tailed_lobe(const Sym2<T>& c,
                                            const Sym2<NonDeduced<T>>& light) noexcept {
    // The parallel sum A - A (A + B)^-1 A, with A = C and B = C + light, is the result.
    return c - congruence(inverse(2 * c + light), Mat2<T>(c));
}

/// Smallest cosine of incidence used in `cosine_window`.
template <std::floating_point T>
inline constexpr T min_window_cosine = T(0.05);

/// Angular window of Lambert's cosine, in local slopes: a a^T/(pi^2 cos^2 theta_i) + b b^T/pi^2
/// with a in the plane of incidence and b across it.
///
/// At normal incidence the weight is (1 + u^2 + v^2)^-2, whose covariance is exactly 1/pi^2 per
/// axis. At an angle the horizon is treated as an edge at the slope distance cot theta_i. It does
/// not commute with curvature: add it between `surface_enter` and the integral over directions, not
/// elsewhere.
///
/// Frame    of the arriving light; n: the normal along its X, Y, Z.
/// Errors   none; cosines below 0.05 count as 0.05.
template <std::floating_point T>
[[nodiscard]] Sym2<T> cosine_window(const Vec3<T>& n) noexcept {
    const T c = std::max(std::abs(n.z), min_window_cosine<T>);
    // The tangential part of Z has the transverse coordinates -(Z.n)(n.X, n.Y).
    const T nx = n.x, ny = n.y;
    const T size_sq = nx * nx + ny * ny;
    const T across = 1 / (pi<T> * pi<T>);
    if (!(size_sq > noise_level<T>)) return Sym2<T>::diagonal(across, across);
    const T excess = across * (1 / (c * c) - 1) / size_sq;
    return {across + excess * nx * nx, excess * nx * ny, across + excess * ny * ny};
}

/// The window of Lambert's cosine, from the normal in the scene.
template <std::floating_point T>
[[nodiscard]] Sym2<T> cosine_window(const Frame<T>& incoming,
                                    const Vec3<NonDeduced<T>>& n) noexcept {
    return cosine_window<T>({dot(incoming.x, n), dot(incoming.y, n), dot(incoming.z, n)});
}

}  // namespace covariance
