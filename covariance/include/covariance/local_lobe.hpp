// The lobe of a BRDF at the actual pair of directions instead of at its peak. A single covariance
// per BRDF over-estimates the bandwidth far from the highlight, the first limitation that Belcour
// 2012, "A Frequency Analysis of Light Transport: From Theory to Implementation", names. Derived in
// covariance/RULES.md.
//
// Around a pair of directions f cos = exp(l), l a function of the slopes of both. Along the leaving
// slopes the spectrum of exp(l) has the covariance
//
//   C = (|Hess l| + grad l grad l^T) / (4 pi^2)
//
// For a Gaussian lobe |Hess l| alone is its covariance, wherever the pair lies. In long tails
// (GGX) l is convex, the lobe has no bandwidth of its own, and the sum is Hess f / f exactly: the
// scale on which f changes. |Hess f| / f alone would vanish on a ring around the peak, where f is
// steepest. Never more than the peak's covariance, by which Gaussian tails lose their gradient.
#pragma once

#include "covariance/brdf.hpp"
#include "covariance/jet.hpp"
#include "covariance/refraction.hpp"

namespace covariance {

/// The largest covariance below both `a` and, in every direction, `limit`: eigenvalues relative to
/// `limit` are cut at 1. Where `limit` is singular the result is `limit`.
template <std::floating_point T>
[[nodiscard]] Sym2<T> limited_by(const Sym2<T>& a, const Sym2<NonDeduced<T>>& limit) noexcept {
    if (!(det(limit) > 0)) return limit;
    const auto is_positive = [](const Sym2<T>& m) { return det(m) >= 0 && trace(m) >= 0; };
    if (is_positive(limit - a) && is_positive(a)) return a;
    // With limit = L L^T, L^-1 a L^-T has eigenvalues of at most 1 after the cut.
    const T l00 = std::sqrt(limit.xx), l10 = limit.xy / l00, l11 = std::sqrt(det(limit)) / l00;
    const Mat2<T> to_limit{1 / l00, -l10 / (l00 * l11), 0, 1 / l11};  // L^-T
    const Sym2<T> relative = clamp_eigenvalues(congruence(a, to_limit), T(0), T(1));
    return congruence(relative, Mat2<T>{l00, l10, 0, l11});
}

/// The positive part of a matrix: eigenvalues below 0 become 0.
template <std::floating_point T>
[[nodiscard]] Sym2<T> positive_part(const Sym2<T>& a) noexcept {
    if (det(a) > 0) return a.xx > 0 ? a : Sym2<T>{};  // both of one sign
    return map_eigenvalues(a, [](T l) { return std::max(l, T(0)); });
}

/// The matrix with the eigenvectors of `a` and the absolute values of its eigenvalues.
template <std::floating_point T>
[[nodiscard]] Sym2<T> absolute(const Sym2<T>& a) noexcept {
    if (det(a) > 0) return a.xx > 0 ? a : T(-1) * a;
    return map_eigenvalues(a, [](T l) { return std::abs(l); });
}

/// The derivatives of log f; its value, on which nothing here depends, is left 0.
template <std::floating_point T>
[[nodiscard]] constexpr Jet<T> log_derivatives(const Jet<T>& f) noexcept {
    const T i = 1 / f.value, gu = f.u * i, gv = f.v * i;
    return {0, gu, gv, f.uu * i - gu * gu, f.uv * i - gu * gv, f.vv * i - gv * gv};
}

/// Covariance of the Gaussian that touches f = exp(l): -Hess l / (4 pi^2), of either sign.
template <std::floating_point T>
[[nodiscard]] constexpr Sym2<T> curvature_of_log(const Jet<T>& l) noexcept {
    return (-1 / four_pi_sq<T>)*Sym2<T>{l.uu, l.uv, l.vv};
}

/// Covariance of the Gaussian that touches f, from f itself.
template <std::floating_point T>
[[nodiscard]] constexpr Sym2<T> log_curvature(const Jet<T>& f) noexcept {
    return curvature_of_log(log_derivatives(f));
}

/// The lobe `local_lobe` of f = exp(l), from the derivatives of l.
template <std::floating_point T>
[[nodiscard]] Sym2<T> local_lobe_of_log(const Jet<T>& l, const Sym2<NonDeduced<T>>& peak) noexcept {
    const Sym2<T> steep = (1 / four_pi_sq<T>)*Sym2<T>{l.u * l.u, l.u * l.v, l.v * l.v};
    const Sym2<T> local = absolute(curvature_of_log(l)) + steep;
    return std::isfinite(trace(local)) ? limited_by(local, peak) : peak;
}

/// Covariance C of a lobe f at the actual pair: (|Hess log f| + grad log f grad log f^T) / (4
/// pi^2), at most `peak`.
///
/// Shapes   f: BRDF * cos as a jet in the leaving slopes; any constant factor cancels.
///          peak: the global covariance in the same axes, for instance `glossy_lobe`.
/// Units    1/rad^2. Errors: where f is not positive or not finite the peak is returned.
/// Source   the idea is in Belcour's course notes of 2016; the form is derived in RULES.md.
template <std::floating_point T>
[[nodiscard]] Sym2<T> local_lobe(const Jet<T>& f, const Sym2<NonDeduced<T>>& peak) noexcept {
    return f.value > 0 ? local_lobe_of_log(log_derivatives(f), peak) : peak;
}

/// The effect of a BRDF on light around one pair of directions.
template <std::floating_point T = double>
struct LocalLobe {
    Sym2<T> window;      ///< factor on the arriving light, in arriving slopes
    GlossyPair<T> pair;  ///< with the lobe at these directions in place of the one at the peak
};

/// The local lobe and window of f(wi, wo) = BRDF * |cos(wi)|.
///
/// The lobe is `local_lobe` in the leaving slopes. What f depends on the arriving slopes *beyond*
/// the lobe (the cosine, masking near the horizon, the measure of slopes) is a window: the positive
/// part of -Hess log(f dw/du)/(4 pi^2) minus that of the lobe, at most `window_limit`.
///
/// Shapes   f: callable with two JetVec3, unit vectors that point away from the surface, wi towards
///          the light; any constant factor cancels. to_local: takes world vectors (Vec3) to the
///          coordinates in which f wants its directions. pair: from `reflection_pair` or
///          `refraction_pair` of the same `incoming`; its lobe is the limit. window_limit: in the
///          axes of `incoming`, usually `cosine_window`.
/// Errors   none; where f is not positive: the peak, and no window.
template <std::floating_point T, typename F, typename ToLocal>
[[nodiscard]] LocalLobe<T> local_lobe(const F& f, const ToLocal& to_local, const Frame<T>& incoming,
                                      const GlossyPair<NonDeduced<T>>& pair,
                                      const Sym2<NonDeduced<T>>& window_limit) noexcept {
    const Vec3<T> xi = to_local(incoming.x), yi = to_local(incoming.y), zi = to_local(incoming.z);
    const Frame<T>& out = pair.outgoing;
    const Vec3<T> xo = to_local(out.x), yo = to_local(out.y), zo = to_local(out.z);
    const Jet<T> leaving = f(jet_constant<T>(-zi), jet_direction<T>(xo, yo, zo));
    const Jet<T> arriving =
        f(jet_direction<T>(-xi, -yi, -zi), jet_constant<T>(zo)) * jet_solid_angle<T>();
    LocalLobe<T> local{{}, {out, pair.map, local_lobe<T>(leaving, pair.lobe)}};
    if (!(leaving.value > 0) || !(arriving.value > 0)) return local;
    const Sym2<T> own = congruence(log_curvature(leaving), inverse(pair.map));
    const Sym2<T> window = positive_part(log_curvature(arriving) - own);
    if (std::isfinite(trace(window))) local.window = limited_by(window, window_limit);
    return local;
}

/// Reflects or refracts light by a local lobe: window, map of the slopes, convolution.
///
/// Between `surface_enter` and `surface_exit`; `lobe` made with the frame of `field`.
template <std::floating_point T>
[[nodiscard]] LightField<T> scatter(const LightField<T>& field,
                                    const LocalLobe<NonDeduced<T>>& lobe) noexcept {
    return scatter(add_angular_window(field, lobe.window), lobe.pair);
}

}  // namespace covariance
