// Contours: where a curved surface turns away from a ray that leaves it. Its light ends there, an
// edge that the light's own covariance does not know: an occluder stands between the surface and
// who sees it, the contour at or behind the point where the ray starts.
//
// Near the point the normals of the tangent displacement q are n + kappa q, so the outline as seen
// along o (n.o = cos theta > 0) is the line n.o + (kappa q).o = 0. As o has the tangent part
// -sin theta t, it lies beside the ray in the direction
//
//   m = cos(phi) (cos(theta) t + sin(theta) n) + sin(phi) b,
//   tan(phi) = cos(theta) kappa_tb/kappa_tt
//
// (b = n x t), the normal of the surface there. On the way from n to m the surface turns about one
// axis, along a circle of the radius R = kappa_tt/(kappa_tt^2 + kappa_tb^2), so that the edge is
// R (1 - m.n) from the ray. Exact for spheres and cylinders; derived in RULES.md.
#pragma once

#include <cmath>
#include <optional>

#include "covariance/motion.hpp"
#include "covariance/occlusion.hpp"
#include "covariance/surface.hpp"
#include "covariance/travel.hpp"

namespace covariance {

/// The part of a surface's outline that is nearest to a ray that leaves it.
template <std::floating_point T = double>
struct Contour {
    Vec3<T> direction{};  ///< unit, from the ray to the outline, at right angles to the ray
    T distance = 0;       ///< scene units, from the ray along `direction`
    Vec3<T> offset{};     ///< from where the ray starts to the outline
};

/// Cosine of the largest angle, one radian, between the normals at the point and at its contour:
/// farther away the curvature at the point tells little of the surface.
template <std::floating_point T>
inline constexpr T least_contour_cosine = T(0.54);

/// The contour of a surface beside the ray that leaves it along the unit vector `outgoing`; none
/// where the surface is flat or hollow along the ray, or turns away too late to be known.
///
/// Errors   none; NaN in gives none.
template <std::floating_point T>
[[nodiscard]] std::optional<Contour<T>> contour(const Surface<T>& surface,
                                                const Vec3<NonDeduced<T>>& outgoing) noexcept {
    const Sym2<T>& k = surface.curvature;
    if (k == Sym2<T>{}) return std::nullopt;
    const T side = dot(surface.n, outgoing) < 0 ? T(-1) : T(1);
    const Vec3<T> n = side * surface.n;
    const T c = dot(n, outgoing), a1 = -dot(outgoing, surface.t1), a2 = -dot(outgoing, surface.t2);
    const T s = std::sqrt(a1 * a1 + a2 * a2);
    if (!(s >= least_contour_cosine<T>)) return std::nullopt;
    const T t1 = a1 / s, t2 = a2 / s;
    const T kt1 = side * (k.xx * t1 + k.xy * t2), kt2 = side * (k.xy * t1 + k.yy * t2);
    const T ktt = kt1 * t1 + kt2 * t2, ktb = kt2 * t1 - kt1 * t2;  // b = (-t2, t1)
    if (!(ktt > 0)) return std::nullopt;
    const T tan_phi = c * ktb / ktt, cos_phi = 1 / std::sqrt(1 + tan_phi * tan_phi);
    const T along_n = cos_phi * s;
    if (!(along_n >= least_contour_cosine<T>)) return std::nullopt;
    const T sin_phi = tan_phi * cos_phi, m1 = cos_phi * c * t1 - sin_phi * t2,
            m2 = cos_phi * c * t2 + sin_phi * t1;
    const T radius = ktt / (ktt * ktt + ktb * ktb);
    const T drop = (m1 * m1 + m2 * m2) / (1 + along_n);  // 1 - along_n without its cancellation
    const Vec3<T> across = m1 * surface.t1 + m2 * surface.t2;
    Contour<T> result{across + along_n * n, radius * drop, radius * (across - drop * n)};

    // Along the outline to its point beside the ray; the axis of the turn is the outline itself.
    const T scale = 1 / std::sqrt(kt1 * kt1 + kt2 * kt2);
    const Vec3<T> line = (scale * kt1) * surface.t2 - (scale * kt2) * surface.t1;
    const Vec3<T> sideways = cross(Vec3<T>(outgoing), result.direction);
    const T leans = dot(line, sideways);
    if (std::abs(leans) > T(0.2))
        result.offset = result.offset - (dot(result.offset, sideways) / leans) * line;
    return result;
}

/// Lets light end at a contour of the surface that it has just left: an edge, at its distance and
/// its place along the ray, which moves with the body.
///
/// Frame    of the leaving ray, after `motion_exit`. `motion` is that of the point it leaves.
/// Units    distances below distance_min, scene units above 0, count as distance_min.
template <std::floating_point T>
[[nodiscard]] LightField<T> end_at_contour(const LightField<T>& field,
                                           const Contour<NonDeduced<T>>& contour,
                                           NonDeduced<T> distance_min,
                                           const Motion<NonDeduced<T>>& motion = {},
                                           NonDeduced<T> beta = edge_beta<T>) noexcept {
    const Frame<T>& f = field.frame;
    const Vec3<T> velocity = motion.velocity + cross(motion.angular_velocity, contour.offset);
    const T ahead = dot(contour.offset, f.z);
    const auto there = travel(field.sigma, ahead);
    const auto ended = occlude(there, dot(contour.direction, f.x), dot(contour.direction, f.y),
                               std::max(contour.distance, distance_min), dot(velocity, f.x),
                               dot(velocity, f.y), beta);
    return {travel(ended, -ahead), f};
}

}  // namespace covariance
