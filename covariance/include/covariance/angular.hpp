// Operations of a surface on slopes alone: windows (a product of signals adds covariances),
// convolution with a lobe (a product of spectra), and linear maps of the slopes.
#pragma once

#include <algorithm>

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

/// Multiplies a light field by an angular window; its frame stays.
template <std::floating_point T>
[[nodiscard]] constexpr LightField<T> add_angular_window(
    const LightField<T>& field, const Sym2<NonDeduced<T>>& window) noexcept {
    return {add_angular_window(field.sigma, window), field.frame};
}

namespace detail {

/// Elimination of the axes P and Q (u and v in either order) by B, an angular block whose larger
/// diagonal entry is that of P: B = L diag(d1, d2) L^T with L = [1 0; l 1]. Unlike an explicit
/// inverse it keeps its accuracy where B is nearly singular. A second pivot that is only rounding
/// noise is left out, which gives a generalised inverse.
template <std::size_t P, std::size_t Q, std::floating_point T>
struct AngularPivots {
    T inv1, l, inv2;

    /// Pivots of B. Pre: B(P, P) > 0.
    explicit constexpr AngularPivots(const Sym2<T>& b) noexcept {
        const T bq = along<Q>(b);
        inv1 = 1 / along<P>(b);
        l = b.xy * inv1;
        const T d2 = multiply_add(-l, b.xy, bq);
        inv2 = d2 <= noise_level<T> * bq ? T(0) : 1 / d2;
    }
    /// Diagonal entry of `b` along axis I.
    template <std::size_t I>
    [[nodiscard]] static constexpr T along(const Sym2<T>& b) noexcept {
        return I == axis::u ? b.xx : b.yy;
    }

    /// One row r of R as the elimination needs it: L^-1 r, and that over the pivots.
    struct Row {
        T r1, r2, over1, over2;
    };
    [[nodiscard]] constexpr Row row(T rp, T rq) const noexcept {
        const T r2 = multiply_add(-l, rp, rq);
        return {rp, r2, rp * inv1, r2 * inv2};
    }
    [[nodiscard]] constexpr Row row(const SymmetricMatrix5<T>& s, std::size_t i) const noexcept {
        return row(s(i, P), s(i, Q));
    }

    /// The entry that the elimination leaves of `a`: a - r B^-1 s^T.
    [[nodiscard]] static constexpr T rest(T a, const Row& r, const Row& s) noexcept {
        return multiply_add(-r.over1, s.r1, multiply_add(-r.over2, s.r2, a));
    }
    /// Writes to `to` the position and time block of `s` less R^T B^-1 R.
    static constexpr void eliminate(SymmetricMatrix5<T>& to, const SymmetricMatrix5<T>& s,
                                    const Row& x, const Row& y, const Row& t) noexcept {
        to(0, 0) = rest(s(0, 0), x, x);
        to(0, 1) = rest(s(0, 1), x, y);
        to(0, 4) = rest(s(0, 4), x, t);
        to(1, 1) = rest(s(1, 1), y, y);
        to(1, 4) = rest(s(1, 4), y, t);
        to(4, 4) = rest(s(4, 4), t, t);
    }

    /// Sets to zero those variances in `to` that are only rounding noise beside those of `s`.
    static constexpr void drop_noise(SymmetricMatrix5<T>& to,
                                     const SymmetricMatrix5<T>& s) noexcept {
        constexpr T noise = 16 * std::numeric_limits<T>::epsilon();
        for (const std::size_t i : {axis::x, axis::y, axis::t})
            if (to(i, i) <= noise * s(i, i))
                for (std::size_t j = 0; j < 5; ++j) to(i, j) = 0;
    }

    /// The covariance after integration over all directions; see `slice_angular`.
    [[nodiscard]] constexpr SymmetricMatrix5<T> slice(const SymmetricMatrix5<T>& s) const noexcept {
        SymmetricMatrix5<T> r;
        eliminate(r, s, row(s, 0), row(s, 1), row(s, 4));
        drop_noise(r, s);
        return r;
    }

    /// The covariance after convolution with a kernel; see `convolve_angular`.
    [[nodiscard]] constexpr SymmetricMatrix5<T> convolve(const SymmetricMatrix5<T>& s,
                                                         const Sym2<T>& kernel) const noexcept {
        // Rows u and v are R^T B^-1 C, a form in which nothing cancels.
        const T kp = along<P>(kernel), kq = along<Q>(kernel);
        const auto gain_p = [&](const Row& r) { return multiply_add(-l, r.over2, r.over1); };
        const auto at_p = [&](const Row& r) {
            return sum_of_products(gain_p(r), kp, r.over2, kernel.xy);
        };
        const auto at_q = [&](const Row& r) {
            return sum_of_products(gain_p(r), kernel.xy, r.over2, kq);
        };
        SymmetricMatrix5<T> c;
        const Row x = row(s, 0), y = row(s, 1), t = row(s, 4);
        eliminate(c, s, x, y, t);
        c(0, P) = at_p(x), c(0, Q) = at_q(x);
        c(1, P) = at_p(y), c(1, Q) = at_q(y);
        c(4, P) = at_p(t), c(4, Q) = at_q(t);
        const Row own_p = row(s, P), own_q = row(s, Q);
        c(P, P) = at_p(own_p);
        c(Q, Q) = at_q(own_q);
        c(P, Q) = (at_q(own_p) + at_p(own_q)) / 2;
        drop_noise(c, s);
        return c;
    }
};

}  // namespace detail

/// Integrates over all directions, the angular slice Sigma' = Sigma - R^T R_uv^+ R with R = rows u,
/// v: `convolve_angular` with a kernel that is constant. Rows u and v become exactly zero. `b`: the
/// angular block, with windows by which the light is to be multiplied first.
///
/// Post     positive semi-definite; variances that are only rounding noise are set to zero.
/// Errors   none; NaN in gives NaN out. Exact for Gaussians.
template <std::floating_point T>
[[nodiscard]] constexpr SymmetricMatrix5<T> slice_angular(const SymmetricMatrix5<T>& s,
                                                          const Sym2<NonDeduced<T>>& b) noexcept {
    // Eliminate the axis with the larger pivot first.
    if (std::max(b.xx, b.yy) <= 0) return s;  // no angular content: the rows are zero already
    if (b.xx >= b.yy) return detail::AngularPivots<axis::u, axis::v, T>(b).slice(s);
    return detail::AngularPivots<axis::v, axis::u, T>(b).slice(s);
}

/// Integrates light over all directions, without windows.
template <std::floating_point T>
[[nodiscard]] constexpr SymmetricMatrix5<T> slice_angular(const SymmetricMatrix5<T>& s) noexcept {
    return slice_angular(s, s.angular());
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
    const SymmetricMatrix5<T>& s, const Sym2<NonDeduced<T>>& kernel) noexcept {
    if (kernel == Sym2<T>{}) return slice_angular(s);
    const Sym2<T> b = kernel + s.angular();
    if (std::max(b.xx, b.yy) <= 0) return s;  // neither light nor kernel has angular content
    if (b.xx >= b.yy) return detail::AngularPivots<axis::u, axis::v, T>(b).convolve(s, kernel);
    return detail::AngularPivots<axis::v, axis::u, T>(b).convolve(s, kernel);
}

/// Convolves a light field with an angular kernel; its frame stays.
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
[[nodiscard]] constexpr SymmetricMatrix5<T> map_angular(const SymmetricMatrix5<T>& old,
                                                        const Mat2<NonDeduced<T>>& m) noexcept {
    SymmetricMatrix5<T> s = old;
    s.set_cross(s.cross() * m);
    s.set_angular(congruence(s.angular(), m));
    const T ut = s(2, 4), vt = s(3, 4);
    s(2, 4) = sum_of_products(m.m00, ut, m.m10, vt);
    s(3, 4) = sum_of_products(m.m01, ut, m.m11, vt);
    return s;
}

}  // namespace covariance
