// Entering and leaving a surface: projection onto the tangent plane and curvature, in any frame.
//
//   P = [X.T1 X.T2; Y.T1 Y.T2]       transverse ray position = P * tangent position
//   G_j = ((rho_j x Z).X, (rho_j x Z).Y),  rho_j = n x dn_j,  dn_j = kappa_1j T1 + kappa_2j T2
//
// G turns the slopes into axes that rotate with the normal, so that a BRDF sees one and the same
// local frame everywhere. First order: the footprint is small beside the radius of curvature.
#pragma once

#include <cmath>

#include "covariance/light_field.hpp"
#include "covariance/matrix5.hpp"

namespace covariance {

/// The surface at a vertex: unit normal, tangent basis and shape operator.
template <std::floating_point T = double>
struct Surface {
    Vec3<T> n{0, 0, 1};   ///< unit normal, on either side
    Vec3<T> t1{1, 0, 0};  ///< with t2 an orthonormal basis of the tangent plane
    Vec3<T> t2{0, 1, 0};
    /// Shape operator: dn = curvature * dq, in the basis t1, t2, in 1/scene unit. Convex as seen
    /// from the side of n is positive: +1/R for a sphere whose normal points outwards.
    Sym2<T> curvature{};
};

/// Smallest |cos theta| with which a projection is inverted.
template <std::floating_point T>
inline constexpr T min_surface_cosine = T(0.02);

/// Projection P = [X.T1 X.T2; Y.T1 Y.T2] of the tangent plane; its determinant is +-cos theta.
template <std::floating_point T>
[[nodiscard]] constexpr Mat2<T> surface_projection(const Frame<T>& f,
                                                   const Surface<NonDeduced<T>>& s) noexcept {
    return projection(f, s.t1, s.t2);
}

/// Inverse P^-1 of the projection, with |cos theta| raised to `min_surface_cosine` at grazing
/// angles.
template <std::floating_point T>
[[nodiscard]] Mat2<T> inverse_projection(const Frame<T>& f,
                                         const Surface<NonDeduced<T>>& surface) noexcept {
    Mat2<T> p = surface_projection(f, surface);
    const T c = dot(f.z, surface.n);
    if (std::abs(c) < min_surface_cosine<T>) {
        // The singular values of P are 1 and |c|. The second belongs to the tangent direction
        // `along` the ray and its image b, P along = c b; only that one is replaced.
        const Vec3<T> along = normalized_or(f.z - c * surface.n, surface.t1);
        const Vec3<T> b = c * along - std::sqrt(1 - c * c) * surface.n;
        const T lift = std::copysign(min_surface_cosine<T>, c) - c;
        const T a1 = lift * dot(along, surface.t1), a2 = lift * dot(along, surface.t2);
        const T bx = dot(b, f.x), by = dot(b, f.y);
        p = p + Mat2<T>{bx * a1, bx * a2, by * a1, by * a2};
    }
    return inverse(p);
}

/// A unit normal and its change per displacement along t1 and t2 of a surface: the surface's own,
/// or that of a bump or normal map over it (normal_field.hpp).
template <std::floating_point T = double>
struct NormalField {
    Vec3<T> n{0, 0, 1};
    Vec3<T> d1, d2;  ///< dn/ds1, dn/ds2, in 1/scene unit, orthogonal to n

    /// Whether the normal is the same everywhere.
    [[nodiscard]] constexpr bool is_flat() const noexcept {
        return d1 == Vec3<T>{} && d2 == Vec3<T>{};
    }
};

/// The normals of the geometry itself: dn_j = kappa_1j t1 + kappa_2j t2.
template <std::floating_point T>
[[nodiscard]] constexpr NormalField<T> normal_field(const Surface<T>& s) noexcept {
    return {s.n, s.curvature.xx * s.t1 + s.curvature.xy * s.t2,
            s.curvature.xy * s.t1 + s.curvature.yy * s.t2};
}

/// Change of slope G, per tangent displacement, between world axes and axes that turn with n.
template <std::floating_point T>
[[nodiscard]] constexpr Mat2<T> surface_curvature(
    const Frame<T>& f, const NormalField<NonDeduced<T>>& normals) noexcept {
    if (normals.is_flat()) return {};
    // The double product is (n x d) x Z = d (n.Z) - n (d.Z).
    const Vec3<T>&n = normals.n, &d1 = normals.d1, &d2 = normals.d2;
    const T nx = dot(f.x, n), ny = dot(f.y, n), nz = dot(f.z, n);
    const T z1 = dot(f.z, d1), z2 = dot(f.z, d2);
    return {nz * dot(f.x, d1) - z1 * nx, nz * dot(f.x, d2) - z2 * nx,  //
            nz * dot(f.y, d1) - z1 * ny, nz * dot(f.y, d2) - z2 * ny};
}

/// Change of slope G for the normals of the geometry, in 1/scene unit.
template <std::floating_point T>
[[nodiscard]] constexpr Mat2<T> surface_curvature(const Frame<T>& f,
                                                  const Surface<NonDeduced<T>>& s) noexcept {
    return surface_curvature(f, normal_field(s));
}

/// The shape operator with principal curvatures limited to 1/(2 footprint radius): beyond that the
/// first order, on which these operators rest, means nothing. Units: the radius in scene units.
template <std::floating_point T>
[[nodiscard]] Sym2<T> limit_curvature(const Sym2<T>& curvature,
                                      NonDeduced<T> footprint_radius) noexcept {
    const T limit = 1 / (2 * footprint_radius);
    return clamp_eigenvalues(curvature, -limit, limit);
}

/// Old from new coordinates of a change of positions, [P 0 0; G I 0; 0 0 1].
template <std::floating_point T>
[[nodiscard]] constexpr Matrix5<T> position_matrix(const Mat2<T>& p, const Mat2<T>& g) noexcept {
    return Matrix5<T>::identity().set_block(0, 0, p).set_block(2, 0, g);
}

/// Applies x_old = P x, which is both entering and leaving a flat surface.
template <std::floating_point T>
[[nodiscard]] constexpr SymmetricMatrix5<T> change_positions(
    const SymmetricMatrix5<T>& old, const Mat2<NonDeduced<T>>& p) noexcept {
    SymmetricMatrix5<T> s = old;
    s.set_spatial(congruence(s.spatial(), p));
    s.set_cross(transpose(p) * s.cross());
    const T xt = s(0, 4), yt = s(1, 4);
    s(0, 4) = sum_of_products(p.m00, xt, p.m10, yt);
    s(1, 4) = sum_of_products(p.m01, xt, p.m11, yt);
    return s;
}

/// Applies x_old = P x, u_old = u + G x, which is both entering and leaving a surface.
template <std::floating_point T>
[[nodiscard]] constexpr SymmetricMatrix5<T> change_positions(
    const SymmetricMatrix5<T>& old, const Mat2<NonDeduced<T>>& p,
    const Mat2<NonDeduced<T>>& g) noexcept {
    SymmetricMatrix5<T> s = change_positions(old, p);
    const Sym2<T> angular = s.angular();
    // Light without frequencies over the slopes (after a diffuse reflection, at a source) is not
    // changed by axes that turn.
    if ((angular.xx == 0 && angular.yy == 0) || g == Mat2<T>{}) return s;
    // With the blocks Sxx, Sxu, Suu of the old matrix the new ones are Sxu' = P^T Sxu + G^T Suu and
    // Sxx' = P^T Sxx P + (P^T Sxu) G + G^T Sxu'^T.
    const Mat2<T> projected = s.cross(), both = projected + transpose(g) * Mat2<T>(angular),
                  sum = projected + both;
    const Sym2<T> xx = s.spatial();
    s.set_spatial({xx.xx + sum_of_products(sum.m00, g.m00, sum.m01, g.m10),
                   xx.xy + sum_of_products(projected.m00, g.m01, projected.m01, g.m11) +
                       sum_of_products(both.m10, g.m00, both.m11, g.m10),
                   xx.yy + sum_of_products(sum.m10, g.m01, sum.m11, g.m11)});
    s.set_cross(both);
    const T ut = s(2, 4), vt = s(3, 4);
    s(0, 4) += sum_of_products(g.m00, ut, g.m10, vt);
    s(1, 4) += sum_of_products(g.m01, ut, g.m11, vt);
    return s;
}

/// Old from new coordinates for `surface_enter`: [P 0 0; G I 0; 0 0 1].
template <std::floating_point T>
[[nodiscard]] constexpr Matrix5<T> surface_enter_matrix(
    const Frame<T>& incoming, const Surface<NonDeduced<T>>& surface) noexcept {
    return position_matrix(surface_projection(incoming, surface),
                           surface_curvature(incoming, surface));
}

/// Old from new coordinates for `surface_exit`: [P^-1 0 0; -G P^-1 I 0; 0 0 1].
template <std::floating_point T>
[[nodiscard]] Matrix5<T> surface_exit_matrix(const Frame<T>& outgoing,
                                             const Surface<NonDeduced<T>>& surface) noexcept {
    const Mat2<T> inv = inverse_projection(outgoing, surface);
    return position_matrix(inv, T(-1) * (surface_curvature(outgoing, surface) * inv));
}

/// Goes from ray coordinates to local surface coordinates.
///
/// Afterwards x, y are tangent positions along t1, t2, and u, v slopes relative to the incoming X,
/// Y as they turn with the normal. Undone by `surface_exit` with the same frame.
///
/// Frame    that of the arriving ray.
/// Errors   none; NaN in gives NaN out.
template <std::floating_point T>
[[nodiscard]] constexpr SymmetricMatrix5<T> surface_enter(
    const SymmetricMatrix5<T>& s, const Frame<NonDeduced<T>>& incoming,
    const Surface<NonDeduced<T>>& surface) noexcept {
    if (surface.curvature == Sym2<T>{})
        return change_positions(s, surface_projection(incoming, surface));
    return change_positions(s, surface_projection(incoming, surface),
                            surface_curvature(incoming, surface));
}

/// Enters a surface with a light field; its frame, to which u and v still refer, is unchanged.
template <std::floating_point T>
[[nodiscard]] constexpr LightField<T> surface_enter(
    const LightField<T>& field, const Surface<NonDeduced<T>>& surface) noexcept {
    return {surface_enter(field.sigma, field.frame, surface), field.frame};
}

/// Goes from local surface coordinates to coordinates of the ray that leaves along `outgoing.z`.
///
/// Frame    u and v must be relative to the X, Y of `outgoing`.
/// Errors   none; |cos| of the leaving ray below 0.02 is treated as 0.02.
template <std::floating_point T>
[[nodiscard]] SymmetricMatrix5<T> surface_exit(const SymmetricMatrix5<T>& s,
                                               const Frame<NonDeduced<T>>& outgoing,
                                               const Surface<NonDeduced<T>>& surface) noexcept {
    const Mat2<T> inv = inverse_projection(outgoing, surface);
    if (surface.curvature == Sym2<T>{}) return change_positions(s, inv);
    return change_positions(s, inv, T(-1) * (surface_curvature(outgoing, surface) * inv));
}

/// Leaves a surface with a light field whose frame is the outgoing one, as every reflection and
/// refraction operator of this library leaves it.
template <std::floating_point T>
[[nodiscard]] LightField<T> surface_exit(const LightField<T>& field,
                                         const Surface<NonDeduced<T>>& surface) noexcept {
    return {surface_exit(field.sigma, field.frame, surface), field.frame};
}

/// Leaves a surface with an outgoing frame of the caller's choice: for light without angular
/// content (after a diffuse reflection, at a source), where u and v are zero and any X, Y will do.
template <std::floating_point T>
[[nodiscard]] LightField<T> surface_exit(const LightField<T>& field,
                                         const Surface<NonDeduced<T>>& surface,
                                         const Frame<NonDeduced<T>>& outgoing) noexcept {
    return {surface_exit(field.sigma, outgoing, surface), outgoing};
}

}  // namespace covariance
