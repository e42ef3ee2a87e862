// Sources of light. Area lights are replaced by the Gaussian emitter with the same second moments,
// Sigma_xy = (4 pi^2 S_e)^-1: an event that later integrates over the light (a soft shadow, a
// glossy reflection) then converges to the exact frequency. An emitter that is seen sharply, which
// is directly or through any number of mirrors and clear glass, shows its outline:
// `area_source_in_view` adds the border as an edge at its distance. Where `OccluderGrid` finds the
// emitter's outline it must not be added here again.
//
// Everything is in the rest frame of the emitter; follow with `motion_exit` if it moves.
#pragma once

#include <cmath>

#include "covariance/light_field.hpp"
#include "covariance/surface.hpp"
#include "covariance/texture.hpp"

namespace covariance {

/// Second moments of a rectangle with sides a along t1 and b along t2: diag(a^2, b^2)/12.
template <std::floating_point T>
[[nodiscard]] constexpr Sym2<T> rectangle_moments(T a, NonDeduced<T> b) noexcept {
    return Sym2<T>::diagonal(a * a / 12, b * b / 12);
}

/// Second moments of a disc, and of a sphere seen as a disc: R^2/4 in both directions.
template <std::floating_point T>
[[nodiscard]] constexpr Sym2<T> disc_moments(T radius) noexcept {
    return Sym2<T>::diagonal(radius * radius / 4, radius * radius / 4);
}

/// Second moments of a sphere of the given radius, seen from outside as a disc.
template <std::floating_point T>
[[nodiscard]] constexpr Sym2<T> sphere_moments(T radius) noexcept {
    return disc_moments(radius);
}

/// Second moments of a triangle about its centroid c, along t1, t2: (1/12) sum (v_i - c)(v_i -
/// c)^T.
template <std::floating_point T>
[[nodiscard]] constexpr Sym2<T> triangle_moments(const Vec3<T>& v0, const Vec3<NonDeduced<T>>& v1,
                                                 const Vec3<NonDeduced<T>>& v2,
                                                 const Vec3<NonDeduced<T>>& t1,
                                                 const Vec3<NonDeduced<T>>& t2) noexcept {
    const Vec3<T> c = (T(1) / 3) * (v0 + v1 + v2);
    Sym2<T> sum;
    for (const Vec3<T>& v : {v0 - c, v1 - c, v2 - c}) {
        const T a = dot(v, t1), b = dot(v, t2);
        sum = sum + Sym2<T>{a * a, a * b, b * b};
    }
    return (T(1) / 12) * sum;
}

/// Whether no eigenvalue of (4 pi^2 S)^-1 reaches `cap`. May also be false, to be safe, where S
/// less the smallest moments that `cap` allows is so flat that its determinant in float is
/// rounding.
template <std::floating_point T>
[[nodiscard]] constexpr bool is_spectrum_below(const Sym2<T>& moments, NonDeduced<T> cap) noexcept {
    const T least = 1 / (four_pi_sq<T> * cap);
    const Sym2<T> rest = moments - Sym2<T>::diagonal(least, least);
    return rest.xx > 0 && det(rest) > T(1e-3) * rest.xx * rest.yy;
}

/// Spectrum of a Gaussian of covariance S: (4 pi^2 S)^-1, with no eigenvalue above `cap`.
template <std::floating_point T>
[[nodiscard]] Sym2<T> spectrum_of_moments(const Sym2<T>& moments, NonDeduced<T> cap) noexcept {
    if (is_spectrum_below(moments, cap)) return inverse(four_pi_sq<T> * moments);
    return map_eigenvalues(
        moments, [=](T l) { return l * four_pi_sq<T> * cap > 1 ? 1 / (l * four_pi_sq<T>) : cap; });
}

/// Largest variance that this library starts a path with, of spatial frequencies in 1/(scene
/// unit)^2 and of angular ones in 1/rad^2. Beyond it rounding, not the light, decides the result.
template <std::floating_point T>
inline constexpr T max_source_variance = T(1e8);

/// Starts light at a Lambertian area light, in tangent coordinates of its surface; `surface_exit`
/// must follow.
///
///     field = surface_exit(area_source(disc_moments(r), frame), surface);
///
/// Shapes   moments: in surface.t1, t2; frame: of the leaving ray, Z towards the first vertex.
template <std::floating_point T>
[[nodiscard]] LightField<T> area_source(const Sym2<T>& moments, const Frame<NonDeduced<T>>& frame,
                                        NonDeduced<T> cap = max_source_variance<T>) noexcept {
    LightField<T> field{{}, frame};
    field.sigma.set_spatial(spectrum_of_moments(moments, cap));
    return field;
}

/// Covariance of the border of a rectangle with sides a along t1 and b along t2, for light that is
/// seen at (s1, s2) from the centre: per axis `edge_variance` of the distance to the nearer side.
///
/// Units    scene units; distances below distance_min (above 0) count as distance_min.
template <std::floating_point T>
[[nodiscard]] constexpr Sym2<T> rectangle_border(T a, NonDeduced<T> b, NonDeduced<T> s1,
                                                 NonDeduced<T> s2,
                                                 NonDeduced<T> distance_min) noexcept {
    const T to_1 = a / 2 - (s1 < 0 ? -s1 : s1), to_2 = b / 2 - (s2 < 0 ? -s2 : s2);
    return Sym2<T>::diagonal(edge_variance<T>(std::max(to_1, distance_min)),
                             edge_variance<T>(std::max(to_2, distance_min)));
}

/// Covariance of the border of a disc, for light that is seen at (s1, s2) from the centre: along
/// the radius through that point; in the centre in all directions.
template <std::floating_point T>
[[nodiscard]] Sym2<T> disc_border(T radius, NonDeduced<T> s1, NonDeduced<T> s2,
                                  NonDeduced<T> distance_min) noexcept {
    const T r = std::hypot(s1, s2);
    const T q = edge_variance<T>(std::max(radius - r, distance_min));
    if (!(r > 0)) return Sym2<T>::diagonal(q / 2, q / 2);
    const T c = s1 / r, s = s2 / r;
    return {q * c * c, q * c * s, q * s * s};
}

/// Starts light at an area light that is seen sharply: by the camera, or through mirrors and clear
/// glass alone. Without the border the image of a lamp, and that of its reflection, is smeared.
///
/// Shapes   border: in surface.t1, t2, from `rectangle_border`, `disc_border`, or your own with
///          `edge_variance`. For a sphere none is needed: `end_at_contour` after `surface_exit`.
template <std::floating_point T>
[[nodiscard]] LightField<T> area_source_in_view(
    const Sym2<T>& moments, const Sym2<NonDeduced<T>>& border, const Frame<NonDeduced<T>>& frame,
    NonDeduced<T> cap = max_source_variance<T>) noexcept {
    return add_texture(area_source(moments, frame, cap), border);
}

/// Starts light at a point or spot light, in ray coordinates: Sxx = Syy = 1/(2 pi r_min)^2, a cap.
///
/// Units    r_min in scene units, about 1e-4 of the scene's radius. How large the cap is matters
///          little: a later diffuse reflection, for one, tends to a limit as it grows.
template <std::floating_point T>
[[nodiscard]] constexpr LightField<T> point_source(const Frame<T>& frame,
                                                   NonDeduced<T> r_min) noexcept {
    const T cap = 1 / (four_pi_sq<T> * r_min * r_min);
    return {SymmetricMatrix5<T>::diagonal(cap, cap, 0, 0, 0), frame};
}

/// The angular window of a spot light whose cone falls off with the standard deviation sigma, in
/// radians: to be given to `add_angular_window` right after `point_source`.
template <std::floating_point T>
[[nodiscard]] constexpr Sym2<T> spot_window(T sigma) noexcept {
    const T w = 1 / (four_pi_sq<T> * sigma * sigma);
    return Sym2<T>::diagonal(w, w);
}

/// Starts light from far away with angular content only: Sxx = 0, the given block of u, v along the
/// X, Y of the frame. For an environment map: the local covariance of its mean-free luminance per
/// radian.
template <std::floating_point T>
[[nodiscard]] constexpr LightField<T> distant_source(const Frame<T>& frame,
                                                     const Sym2<NonDeduced<T>>& angular) noexcept {
    LightField<T> field{{}, frame};
    field.sigma.set_angular(angular);
    return field;
}

/// Starts directional light without extent: Suu = Svv = cap, in 1/rad^2.
template <std::floating_point T>
[[nodiscard]] constexpr LightField<T> directional_source(
    const Frame<T>& frame, NonDeduced<T> cap = max_source_variance<T>) noexcept {
    return distant_source(frame, Sym2<T>::diagonal(cap, cap));
}

/// Starts light of a distant disc such as the sun, of angular radius a in radians: Suu = Svv =
/// 1/(pi^2 a^2).
template <std::floating_point T>
[[nodiscard]] constexpr LightField<T> sun_source(const Frame<T>& frame,
                                                 NonDeduced<T> angular_radius) noexcept {
    const T a = 1 / (pi<T> * pi<T> * angular_radius * angular_radius);
    return distant_source(frame, Sym2<T>::diagonal(a, a));
}

}  // namespace covariance
