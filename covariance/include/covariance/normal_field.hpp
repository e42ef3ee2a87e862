// Surfaces whose shading normal is not that of their geometry: bump maps, normal maps, interpolated
// normals. Positions stay those of the geometry; only the turning of the normal changes, and with
// it the shear of curvature. Derived in RULES.md.
#pragma once

#include "covariance/brdf.hpp"
#include "covariance/surface.hpp"

namespace covariance {

/// A map over the geometry: slopes (a, b) of its height along t1, t2, n' ~ n - a t1 - b t2, and
/// how they change.
///
/// Units    slopes without unit; changes in 1/scene unit, changes = d(a, b)/d(s1, s2). For a bump
///          map of height h: the gradient and the Hessian of h. A normal map with the tangent-space
///          normal (m1, m2, m3) has (a, b) = -(m1, m2)/m3, and changes need not be symmetric.
template <std::floating_point T = double>
struct MapSlopes {
    T a = 0, b = 0;
    Mat2<T> changes{};
};

/// The normals of a bump or normal map over the geometry.
///
/// Exact to first order for any slopes: the tangents are carried along with the geometry,
/// dn = kappa_j, dt_i = -kappa_ij n. Where the map is flat this is `normal_field(s)` with the
/// curvature kappa - Hess h.
template <std::floating_point T>
[[nodiscard]] NormalField<T> normal_field(const Surface<T>& s,
                                          const MapSlopes<NonDeduced<T>>& map) noexcept {
    const NormalField<T> base = normal_field(s);
    const T length_sq = 1 + map.a * map.a + map.b * map.b, i = 1 / std::sqrt(length_sq);
    const Vec3<T> n = i * (s.n - map.a * s.t1 - map.b * s.t2);
    const auto turned = [&](const Vec3<T>& dn, T da, T db) {
        const T lift = map.a * dot(dn, s.t1) + map.b * dot(dn, s.t2);
        const Vec3<T> d = dn + lift * s.n - da * s.t1 - db * s.t2;
        return i * (d - dot(d, n) * n);
    };
    return {n, turned(base.d1, map.changes.m00, map.changes.m10),
            turned(base.d2, map.changes.m01, map.changes.m11)};
}

/// The surface as a BSDF sees it: its tangents turned with the normal by the smallest rotation. For
/// the scattering operators between `surface_enter` and `surface_exit`, which take positions from
/// the geometry.
template <std::floating_point T>
[[nodiscard]] Surface<T> shading_surface(const Surface<T>& s,
                                         const NormalField<NonDeduced<T>>& normals) noexcept {
    return {normals.n, rotate_between<T>(s.n, normals.n, s.t1),
            rotate_between<T>(s.n, normals.n, s.t2), s.curvature};
}

/// Enters a surface whose normals are those of a map: positions on the geometry, slopes in axes
/// that turn with the mapped normal. See `surface_enter`.
template <std::floating_point T>
[[nodiscard]] constexpr LightField<T> surface_enter(
    const LightField<T>& field, const Surface<NonDeduced<T>>& surface,
    const NormalField<NonDeduced<T>>& normals) noexcept {
    return {change_positions(field.sigma, surface_projection(field.frame, surface),
                             surface_curvature(field.frame, normals)),
            field.frame};
}

/// Leaves a surface whose normals are those of a map; the same surface and normals as at entry. See
/// `surface_exit`.
template <std::floating_point T>
[[nodiscard]] LightField<T> surface_exit(const LightField<T>& field,
                                         const Surface<NonDeduced<T>>& surface,
                                         const NormalField<NonDeduced<T>>& normals) noexcept {
    const Mat2<T> inv = inverse_projection(field.frame, surface);
    return {
        change_positions(field.sigma, inv, T(-1) * (surface_curvature(field.frame, normals) * inv)),
        field.frame};
}

/// The slope distribution of a rough surface under a map too fine to be seen: distributions of
/// slopes convolve, so their variances add, Cm' = (Cm^-1 + 4 pi^2 V)^-1.
///
/// Shapes   micro: as from `micro_ggx`, along t1, t2; V: covariance of the map's slopes inside the
///          footprint, same axes, without unit. A smooth surface is the limit of infinite micro:
///          (4 pi^2 V)^-1.
template <std::floating_point T>
[[nodiscard]] constexpr Sym2<T> roughened(const Sym2<T>& micro,
                                          const Sym2<NonDeduced<T>>& slope_variance) noexcept {
    return inverse(inverse(micro) + four_pi_sq<T> * slope_variance);
}

}  // namespace covariance
