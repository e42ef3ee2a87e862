// Textures: factors of the light on a surface. The covariances of factors add, here to the block of
// the positions x, y.
//
// A texture's bandwidth must know the distance to its nearest edge; a fixed bandwidth (such as the
// first harmonic of a checkerboard) cannot see that a pixel lies beside one.
#pragma once

#include <algorithm>
#include <cmath>

#include "covariance/light_field.hpp"
#include "covariance/surface.hpp"

namespace covariance {

/// Fraction of the distance to an edge that is taken as standard deviation of the window which
/// keeps the light field away from it.
template <std::floating_point T>
inline constexpr T edge_beta = T(0.5);

/// Variance 1/(4 pi^2 beta^2 r^2) that a hard edge at the distance r contributes along the
/// direction to it. An edge has no finite second moment; this is the window that stays clear of it.
template <std::floating_point T>
[[nodiscard]] constexpr T edge_variance(T distance, NonDeduced<T> beta = edge_beta<T>) noexcept {
    return 1 / (four_pi_sq<T> * beta * beta * distance * distance);
}

/// Multiplies the light by a texture: Sigma_xy += T2.
///
/// Frame    tangent coordinates t1, t2, between `surface_enter` and `surface_exit`; before or after
///          the BRDF makes no difference. Also for a textured emitter, before its `surface_exit`.
/// Units    T2 in 1/m^2, an amplitude covariance of the mean-free texture.
template <std::floating_point T>
[[nodiscard]] constexpr SymmetricMatrix5<T> add_texture(
    SymmetricMatrix5<T> s, const Sym2<NonDeduced<T>>& texture) noexcept {
    s.set_spatial(s.spatial() + texture);
    return s;
}

/// Multiplies a light field by a texture; its frame stays.
template <std::floating_point T>
[[nodiscard]] constexpr LightField<T> add_texture(const LightField<T>& field,
                                                  const Sym2<NonDeduced<T>>& texture) noexcept {
    return {add_texture(field.sigma, texture), field.frame};
}

/// Covariance of a texture in tangent coordinates: T2 = D^T T_uv D with D = d(tex u, tex v)/d(s1,
/// s2).
template <std::floating_point T>
[[nodiscard]] constexpr Sym2<T> texture_on_surface(const Sym2<T>& texture,
                                                   const Mat2<NonDeduced<T>>& d_uv) noexcept {
    return congruence(texture, d_uv);
}

/// Covariance of a checkerboard, or of any texture whose edges run along its own axes: per axis a
/// T_aa = 1/(4 pi^2 beta^2 max(e_a, e_min)^2), e_a the distance to the nearest edge along that
/// axis.
///
/// Both axes count always: with the nearest edge alone the image has star-shaped faults along the
/// lines.
/// Units    distances in texture coordinates; e_min about half a pixel's footprint, above 0.
template <std::floating_point T>
[[nodiscard]] constexpr Sym2<T> checkerboard_texture(T edge_u, NonDeduced<T> edge_v,
                                                     NonDeduced<T> edge_min,
                                                     NonDeduced<T> beta = edge_beta<T>) noexcept {
    return Sym2<T>::diagonal(edge_variance(std::max(edge_u, edge_min), beta),
                             edge_variance(std::max(edge_v, edge_min), beta));
}

/// Covariance of a texture seen through one window of an image: J/(2 pi^2) min(1, m/0.1), with J =
/// <grad grad^T> over the variance in the window and m = standard deviation over mean.
///
/// The factor 2 pi^2 (not 4 pi^2) turns the power of a noise-like texture into an amplitude
/// covariance.
/// Shapes   structure: J; contrast: m.
/// Units    J in 1/(texture unit)^2. Errors: none; a window without contrast gives zero.
template <std::floating_point T>
[[nodiscard]] constexpr Sym2<T> image_texture(const Sym2<T>& structure,
                                              NonDeduced<T> contrast) noexcept {
    return (std::min(T(1), contrast / T(0.1)) / (2 * pi<T> * pi<T>)) * structure;
}

/// Covariance of a solid (three-dimensional) texture on a surface that cuts through it: B^T T B, B
/// = [t1 t2].
///
/// Restricting a signal to a plane projects its spectrum onto that plane, so its second moments are
/// the block of the two tangents; frequencies along the normal are not seen. Exact for any
/// positive spectrum.
/// Shapes   solid: world axes, 1/scene unit^2, e.g. `solid_checkerboard` or `solid_noise`.
template <std::floating_point T>
[[nodiscard]] constexpr Sym2<T> solid_texture(const Sym3<T>& solid,
                                              const Surface<NonDeduced<T>>& surface) noexcept {
    return restrict_to(solid, surface.t1, surface.t2);
}

/// Covariance of a solid checkerboard of axes x, y, z: per axis `edge_variance` of the distance to
/// the nearest face of its cells along that axis.
///
/// Units    scene units; e_min about half a pixel's footprint, above 0.
template <std::floating_point T>
[[nodiscard]] constexpr Sym3<T> solid_checkerboard(const Vec3<T>& edges, NonDeduced<T> e_min,
                                                   NonDeduced<T> beta = edge_beta<T>) noexcept {
    return {edge_variance(std::max(edges.x, e_min), beta),
            0,
            0,
            edge_variance(std::max(edges.y, e_min), beta),
            0,
            edge_variance(std::max(edges.z, e_min), beta)};
}

/// Covariance of solid noise without preferred direction, taken as a sum of waves in random
/// directions: f^2/3 along every axis, with f^2 the mean square of the waves' frequencies. For
/// octaves that is the mean of their squared frequencies, weighted by their amplitudes.
///
/// Units    frequency: f, in cycles/scene unit.
template <std::floating_point T>
[[nodiscard]] constexpr Sym3<T> solid_noise(T frequency) noexcept {
    const T along = frequency * frequency / 3;
    return {along, 0, 0, along, 0, along};
}

/// The sharper of two textures (levels of a pyramid of windows): the one with the greater trace.
template <std::floating_point T>
[[nodiscard]] constexpr Sym2<T> sharper(const Sym2<T>& a, const Sym2<T>& b) noexcept {
    return trace(b) > trace(a) ? b : a;
}

}  // namespace covariance
