// Sheets that let light pass without bending it: thin sheets, alpha masks, borders between media,
// veils. Derived in covariance/RULES.md, section 5. A sheet that scatters is `reflect_diffuse` with
// the outgoing direction on its other side.
#pragma once

#include "covariance/occlusion.hpp"
#include "covariance/surface.hpp"

namespace covariance {

/// Passes straight through a surface whose transmittance varies with position: the light keeps its
/// frame and its slopes, and Sigma_xy += P^-T T P^-1.
///
/// It equals surface_enter, add_texture, surface_exit, in one step: curvature undoes on the way out
/// what it does on the way in. To be called in ray coordinates, without enter and exit.
/// Shapes   texture: in surface.t1, t2, 1/m^2, of the transmittance (for an alpha mask of 1 -
///          alpha); zero for a plain sheet or a border between media, which change nothing.
/// Errors   none; |cos| below 0.02 counts as 0.02.
template <std::floating_point T>
[[nodiscard]] LightField<T> pass_through(const LightField<T>& field,
                                         const Surface<NonDeduced<T>>& surface,
                                         const Sym2<NonDeduced<T>>& texture) noexcept {
    LightField<T> out = field;
    out.sigma.set_spatial(field.sigma.spatial() +
                          congruence(texture, inverse_projection(field.frame, surface)));
    return out;
}

/// Visibility of an edge beyond which only the share `transmittance` of the light arrives: min(1,
/// m/0.1) with m = (1 - t)/(1 + t), deviation over mean of the two levels.
///
/// It is 1 for an opaque edge and for every contrast that can be seen, 0 for none: the same
/// threshold as for textures, `image_texture`.
template <std::floating_point T>
[[nodiscard]] constexpr T edge_visibility(T transmittance) noexcept {
    return std::min(T(1), (1 - transmittance) / ((1 + transmittance) * T(0.1)));
}

/// Adds the edge of something that darkens without hiding: the border of an absorbing medium, of a
/// veil, of a half-transparent mask.
///
/// The covariance is that of `occlude`, scaled by `edge_visibility(transmittance)`.
template <std::floating_point T>
[[nodiscard]] LightField<T> occlude_partly(const LightField<T>& field,
                                           const Vec3<NonDeduced<T>>& offset,
                                           NonDeduced<T> distance_min, NonDeduced<T> transmittance,
                                           const Vec3<NonDeduced<T>>& velocity = {}) noexcept {
    const T seen = edge_visibility(transmittance);
    if (!(seen > 0)) return field;
    return occlude(field, offset, distance_min, velocity, edge_beta<T> / std::sqrt(seen));
}

/// Contrast of 1 - f from that of f: the deviation is the same, the mean is not. Such is the light
/// that passes an alpha mask, of which the surface itself shows the share f = alpha.
///
/// Units    contrast: deviation over mean of f; mean of f, in [0, 1). A mean of 1 gives infinity,
///          which `image_texture` limits.
template <std::floating_point T>
[[nodiscard]] constexpr T contrast_of_complement(T contrast, NonDeduced<T> mean) noexcept {
    return contrast * mean / (1 - mean);
}

}  // namespace covariance
