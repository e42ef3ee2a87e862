// What a surface does to slopes alone: windows (a product of signals adds covariances), convolution
// with a lobe (a product of spectra), and linear maps of the slopes.
#pragma once

#include "covariance/light_field.hpp"
#include "covariance/matrix5.hpp"

namespace covariance {

/// Multiplies the light by an angular window: Suu, Suv, Svv grow by its covariance W.
///
/// Units    W in 1/rad^2; a Gaussian window of standard deviation s has W = 1/(4 pi^2 s^2).
/// Errors   none. Exact where both spectra are positive, 20 to 30 % on the variance otherwise.
template <std::floating_point T>
[[nodiscard]] constexpr SymmetricMatrix5<T> add_angular_window(
    SymmetricMatrix5<T> s, const Sym2<NonDeduced<T>>& window) noexcept {
    s.set_angular(s.angular() + window);
    return s;
}

/// The same on a light field, whose frame stays.
template <std::floating_point T>
[[nodiscard]] constexpr LightField<T> add_angular_window(
    const LightField<T>& field, const Sym2<NonDeduced<T>>& window) noexcept {
    return {add_angular_window(field.sigma, window), field.frame};
}

/// Integrates over all directions, the angular slice Sigma' = Sigma - R^T R_uv^+ R with R = rows u,
/// v: `convolve_angular` with a kernel that is constant. Rows u and v become exactly zero.
///
/// Post     positive semi-definite; variances that are only rounding noise are set to zero.
/// Errors   none; NaN in gives NaN out. Exact for Gaussians.
template <std::floating_point T>
[[nodiscard]] constexpr SymmetricMatrix5<T> slice_angular(const SymmetricMatrix5<T>& s) noexcept {
    // Elimination with the larger pivot p first, as in `convolve_angular`.
    const Sym2<T> b = s.angular();
    const bool u_first = b.xx >= b.yy;
    const std::size_t p = u_first ? axis::u : axis::v, q = u_first ? axis::v : axis::u;
    const T bp = u_first ? b.xx : b.yy, bq = u_first ? b.yy : b.xx;
    if (bp <= 0) return s;  // no angular content: the rows are zero already
    const T inv1 = 1 / bp, l = b.xy * inv1, d2 = bq - l * b.xy;
    const T inv2 = d2 <= noise_level<T> * bq ? T(0) : 1 / d2;
    const T x1 = s(0, p), y1 = s(1, p), t1 = s(p, 4);
    const T x2 = s(0, q) - l * x1, y2 = s(1, q) - l * y1, t2 = s(q, 4) - l * t1;
    SymmetricMatrix5<T> r;
    r(0, 0) = s(0, 0) - x1 * x1 * inv1 - x2 * x2 * inv2;
    r(0, 1) = s(0, 1) - x1 * y1 * inv1 - x2 * y2 * inv2;
    r(0, 4) = s(0, 4) - x1 * t1 * inv1 - x2 * t2 * inv2;
    r(1, 1) = s(1, 1) - y1 * y1 * inv1 - y2 * y2 * inv2;
    r(1, 4) = s(1, 4) - y1 * t1 * inv1 - y2 * t2 * inv2;
    r(4, 4) = s(4, 4) - t1 * t1 * inv1 - t2 * t2 * inv2;
    constexpr T noise = 16 * std::numeric_limits<T>::epsilon();
    if (r(0, 0) <= noise * s(0, 0)) r(0, 0) = r(0, 1) = r(0, 4) = 0;
    if (r(1, 1) <= noise * s(1, 1)) r(0, 1) = r(1, 1) = r(1, 4) = 0;
    if (r(4, 4) <= noise * s(4, 4)) r(0, 4) = r(1, 4) = r(4, 4) = 0;
    return r;
}

/// Convolves the light with an angular kernel whose spectrum has the covariance C.
///
///     Sigma' = Sigma - R^T (C + R_uv)^-1 R,   R = rows u, v of Sigma,  R_uv its angular block
///
/// which is (Sigma^-1 + E C^-1 E^T)^-1 where the inverses exist, and holds for singular Sigma too.
/// C = 0 (a kernel that is constant over all directions) is `slice_angular`. A very large C (a very
/// sharp lobe) changes nothing.
///
/// Units    C in 1/rad^2, in the axes of u and v.
/// Post     positive semi-definite; variances that are only rounding noise are set to zero.
/// Errors   none; NaN in gives NaN out. Exact for Gaussians.
template <std::floating_point T>
[[nodiscard]] constexpr SymmetricMatrix5<T> convolve_angular(
    SymmetricMatrix5<T> s, const Sym2<NonDeduced<T>>& kernel) noexcept {
    if (kernel == Sym2<T>{}) return slice_angular(s);
    const Sym2<T> own = s.angular(), b = kernel + own;

    // Elimination with the larger pivot p first: B = L diag(d1, d2) L^T with L = [1 0; l 1]. Unlike
    // an explicit inverse it keeps its accuracy where B is nearly singular. A second pivot that is
    // only rounding noise is left out, which gives a generalised inverse.
    const bool u_first = b.xx >= b.yy;
    const std::size_t p = u_first ? axis::u : axis::v, q = u_first ? axis::v : axis::u;
    const T bp = u_first ? b.xx : b.yy, bq = u_first ? b.yy : b.xx;
    if (bp <= 0) return s;  // neither light nor kernel has angular content
    const T inv1 = 1 / bp, l = b.xy * inv1, d2 = bq - l * b.xy;
    const T inv2 = d2 <= noise_level<T> * bq ? T(0) : 1 / d2;
    const T xx = s(0, 0), yy = s(1, 1), tt = s(4, 4);
    const T x1 = s(0, p), y1 = s(1, p), t1 = s(p, 4);
    const T x2 = s(0, q) - l * x1, y2 = s(1, q) - l * y1, t2 = s(q, 4) - l * t1;
    s(0, 0) -= x1 * x1 * inv1 + x2 * x2 * inv2;
    s(0, 1) -= x1 * y1 * inv1 + x2 * y2 * inv2;
    s(0, 4) -= x1 * t1 * inv1 + x2 * t2 * inv2;
    s(1, 1) -= y1 * y1 * inv1 + y2 * y2 * inv2;
    s(1, 4) -= y1 * t1 * inv1 + y2 * t2 * inv2;
    s(4, 4) -= t1 * t1 * inv1 + t2 * t2 * inv2;

    // Rows u and v are R^T B^-1 C, a form in which nothing cancels.
    const T kp = u_first ? kernel.xx : kernel.yy, kq = u_first ? kernel.yy : kernel.xx;
    struct Row {
        T p, q;
    };
    const auto row = [&](T r1, T r2) -> Row {
        const T gain_q = r2 * inv2, gain_p = r1 * inv1 - l * gain_q;
        return {gain_p * kp + gain_q * kernel.xy, gain_p * kernel.xy + gain_q * kq};
    };
    const Row x = row(x1, x2), y = row(y1, y2), t = row(t1, t2);
    s(0, p) = x.p, s(0, q) = x.q;
    s(1, p) = y.p, s(1, q) = y.q;
    s(p, 4) = t.p, s(q, 4) = t.q;
    const T own_p = u_first ? own.xx : own.yy, own_q = u_first ? own.yy : own.xx;
    const Row along_p = row(own_p, own.xy - l * own_p), along_q = row(own.xy, own_q - l * own.xy);
    s(p, p) = along_p.p;
    s(q, q) = along_q.q;
    s(p, q) = (along_p.q + along_q.p) / 2;

    constexpr T noise = 16 * std::numeric_limits<T>::epsilon();
    const auto remove_noise = [&s](std::size_t i, T before) {
        if (s(i, i) <= noise * before)
            for (std::size_t j = 0; j < 5; ++j) s(i, j) = 0;
    };
    remove_noise(axis::x, xx);
    remove_noise(axis::y, yy);
    remove_noise(axis::t, tt);
    return s;
}

/// The same on a light field, whose frame stays.
template <std::floating_point T>
[[nodiscard]] constexpr LightField<T> convolve_angular(const LightField<T>& field,
                                                       const Sym2<NonDeduced<T>>& kernel) noexcept {
    return {convolve_angular(field.sigma, kernel), field.frame};
}

/// Old from new coordinates of a linear map of the slopes, (u, v)_old = M (u, v).
template <std::floating_point T>
[[nodiscard]] constexpr Matrix5<T> angular_map_matrix(const Mat2<T>& m) noexcept {
    return Matrix5<T>::identity().set_block(2, 2, m);
}

/// Applies a linear map of the slopes, (u, v)_old = M (u, v): Suu' = M^T Suu M, Sxu' = Sxu M.
template <std::floating_point T>
[[nodiscard]] constexpr SymmetricMatrix5<T> map_angular(SymmetricMatrix5<T> s,
                                                        const Mat2<NonDeduced<T>>& m) noexcept {
    s.set_cross(s.cross() * m);
    s.set_angular(congruence(s.angular(), m));
    const T ut = s(2, 4), vt = s(3, 4);
    s(2, 4) = m.m00 * ut + m.m10 * vt;
    s(3, 4) = m.m01 * ut + m.m11 * vt;
    return s;
}

}  // namespace covariance
