// Closed forms for aligned axes: X in the plane of incidence, T1 the projection of X, T2 = Y. They
// show what the general operators of surface.hpp and refraction.hpp do, and are tested against
// them.
#pragma once

#include "covariance/matrix5.hpp"
#include "covariance/surface.hpp"

namespace covariance {

/// Old from new coordinates for `project_aligned`, from ray to tangent plane: x_old = cos x.
template <std::floating_point T>
[[nodiscard]] constexpr Matrix5<T> project_aligned_matrix(T cosine) noexcept {
    Matrix5<T> a = Matrix5<T>::identity();
    a(0, 0) = cosine;
    return a;
}

/// Projects from ray to tangent coordinates: Sxx' = cos^2 Sxx, Sxu' = cos Sxu.
template <std::floating_point T>
[[nodiscard]] constexpr SymmetricMatrix5<T> project_aligned(SymmetricMatrix5<T> s,
                                                            NonDeduced<T> cosine) noexcept {
    for (std::size_t j = 0; j < 5; ++j) s(0, j) *= cosine;
    s(0, 0) *= cosine;
    return s;
}

/// Projects from tangent to ray coordinates, the inverse of `project_aligned`. Pre: cosine is not
/// 0.
template <std::floating_point T>
[[nodiscard]] constexpr SymmetricMatrix5<T> unproject_aligned(const SymmetricMatrix5<T>& s,
                                                              NonDeduced<T> cosine) noexcept {
    return project_aligned(s, 1 / cosine);
}

/// Slope matrix G of one half step of curvature: -[k11, k12; cos k12, cos k22]. Across the plane of
/// incidence the angle carries the cosine.
template <std::floating_point T>
[[nodiscard]] constexpr Mat2<T> curvature_aligned_slope(const Sym2<T>& k, T cosine) noexcept {
    return {-k.xx, -k.xy, -cosine * k.xy, -cosine * k.yy};
}

/// Enters the turning frame of a curved surface, in tangent coordinates (and, with the outgoing
/// cosine, leaves it in the mirrored frame): W_x' = W_x - k11 W_u - cos k12 W_v.
template <std::floating_point T>
[[nodiscard]] constexpr SymmetricMatrix5<T> curvature_aligned(const SymmetricMatrix5<T>& s,
                                                              const Sym2<NonDeduced<T>>& curvature,
                                                              NonDeduced<T> cosine) noexcept {
    return change_positions(s, Mat2<T>::identity(), curvature_aligned_slope<T>(curvature, cosine));
}

/// Slope matrix G of a whole curved mirror in ray coordinates: -[2 k11/cos, 2 k12; 2 k12, 2 cos
/// k22], Coddington's tangential 2/(R cos) and sagittal 2 cos/R.
template <std::floating_point T>
[[nodiscard]] constexpr Mat2<T> mirror_aligned_slope(const Sym2<T>& k, T cosine) noexcept {
    return {-2 * k.xx / cosine, -2 * k.xy, -2 * k.xy, -2 * cosine * k.yy};
}

/// Reflection by a curved mirror, ray coordinates before and after, in the mirrored frame.
template <std::floating_point T>
[[nodiscard]] constexpr SymmetricMatrix5<T> mirror_aligned(const SymmetricMatrix5<T>& s,
                                                           const Sym2<NonDeduced<T>>& curvature,
                                                           NonDeduced<T> cosine) noexcept {
    return change_positions(s, Mat2<T>::identity(), mirror_aligned_slope<T>(curvature, cosine));
}

/// Old from new coordinates for `refract_aligned`; c1, c2 are the cosines on the sides of n1, n2:
///
///     x_old = (c1/c2) x      u_old = (n2 c2)/(n1 c1) u + Gamma/(n1 c1) (k11 x/c2 + k12 y)
///     y_old = y              v_old = (n2/n1) v + Gamma/n1 (k12 x/c2 + k22 y),  Gamma = n2 c2 - n1
///     c1
template <std::floating_point T>
[[nodiscard]] constexpr Matrix5<T> refract_aligned_matrix(T n1, T n2, T c1, T c2,
                                                          const Sym2<T>& k) noexcept {
    const T gamma = n2 * c2 - n1 * c1;
    Matrix5<T> a = Matrix5<T>::identity();
    a(0, 0) = c1 / c2;
    a(2, 2) = (n2 * c2) / (n1 * c1);
    a(3, 3) = n2 / n1;
    a(2, 0) = gamma * k.xx / (n1 * c1 * c2);
    a(2, 1) = gamma * k.xy / (n1 * c1);
    a(3, 0) = gamma * k.xy / (n1 * c2);
    a(3, 1) = gamma * k.yy / n1;
    return a;
}

/// Refraction by a curved interface, ray coordinates before and after; Y stays, X stays in the
/// plane of incidence.
///
/// Units    refractive indices n1 before, n2 after; curvature convex on the side of the arriving
///          light. Pre: neither cosine is 0.
template <std::floating_point T>
[[nodiscard]] constexpr SymmetricMatrix5<T> refract_aligned(
    const SymmetricMatrix5<T>& s, NonDeduced<T> n1, NonDeduced<T> n2, NonDeduced<T> cos_i,
    NonDeduced<T> cos_t, const Sym2<NonDeduced<T>>& curvature) noexcept {
    return transform(s, refract_aligned_matrix<T>(n1, n2, cos_i, cos_t, curvature));
}

}  // namespace covariance
