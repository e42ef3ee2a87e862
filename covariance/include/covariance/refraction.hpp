// Refraction, smooth and rough. Called between surface_enter and surface_exit, like reflection.
//
// The tangential optical momentum n P^T w is conserved, which gives the map of the local slopes
//   w_in = (n2/n1) P_in^-T P_out^T w_out
// for any pair of frames. Total internal reflection is a reflection.
#pragma once

#include "covariance/reflection.hpp"

namespace covariance {

/// Map of the local slopes at an interface, old from new: (n2/n1) P_in^-T P_out^T.
///
/// Holds for reflection too with n1 = n2: the identity where `outgoing` is `incoming` mirrored.
template <std::floating_point T>
[[nodiscard]] Mat2<T> specular_map(const Frame<T>& incoming, const Frame<NonDeduced<T>>& outgoing,
                                   const Surface<NonDeduced<T>>& surface, NonDeduced<T> n1,
                                   NonDeduced<T> n2) noexcept {
    return (n2 / n1) * (transpose(inverse_projection(incoming, surface)) *
                        transpose(surface_projection(outgoing, surface)));
}

/// Smooth refraction (or reflection, with n1 = n2) into a frame of the caller's choice.
///
/// Units    refractive indices n1 on the side of the arriving light, n2 of the leaving light.
/// Pre      outgoing.z obeys Snell's law (the law of reflection).
/// Errors   none; incoming |cos| below 0.02 is treated as 0.02.
template <std::floating_point T>
[[nodiscard]] LightField<T> refract_to(const LightField<T>& field,
                                       const Surface<NonDeduced<T>>& surface,
                                       const Frame<NonDeduced<T>>& outgoing, NonDeduced<T> n1,
                                       NonDeduced<T> n2) noexcept {
    return {map_angular(field.sigma, specular_map(field.frame, outgoing, surface, n1, n2)),
            outgoing};
}

/// Smooth refraction into the direction `outgoing`; the frame turns with the ray.
template <std::floating_point T>
[[nodiscard]] LightField<T> refract(const LightField<T>& field,
                                    const Surface<NonDeduced<T>>& surface,
                                    const Vec3<NonDeduced<T>>& outgoing, NonDeduced<T> n1,
                                    NonDeduced<T> n2) noexcept {
    return refract_to(field, surface, turned_to(field.frame, outgoing), n1, n2);
}

/// The pair of directions of a refraction by a rough surface: the map about the microfacet that
/// refracts one direction into the other, h along n1 Zi - n2 Zo, and the lobe (n2/Gamma)^2 P_h Cm
/// P_h^T. Gamma = n2 |h.Zo| - n1 |h.Zi| says how much the microfacet bends the light, P_h projects
/// its tangent plane onto the leaving frame, and Cm is `micro`.
///
/// Shapes   micro: slope covariance in surface.t1, t2.
/// Units    refractive indices n1 on the side of the arriving light, n2 of the leaving light.
/// Errors   none; where the interface hardly bends the light (|Gamma| below 1e-6 n2) the lobe is
///          that of 1e-6 n2, too sharp to change anything.
template <std::floating_point T>
[[nodiscard]] GlossyPair<T> refraction_pair(const Frame<T>& incoming,
                                            const Surface<NonDeduced<T>>& surface,
                                            const Vec3<NonDeduced<T>>& outgoing, NonDeduced<T> n1,
                                            NonDeduced<T> n2,
                                            const Sym2<NonDeduced<T>>& micro) noexcept {
    const Vec3<T> h = normalized_or(n1 * incoming.z - n2 * outgoing, surface.n);
    const Surface<T> facet = tilted(surface, h);
    const Frame<T> frame = turned_to(incoming, outgoing);
    const T bend = n2 * std::abs(dot(h, outgoing)) - n1 * std::abs(dot(h, incoming.z));
    const T ratio = n2 / std::max(std::abs(bend), T(1e-6) * n2);
    const Mat2<T> p_out = surface_projection(frame, facet);
    return {frame, specular_map(incoming, frame, facet, n1, n2),
            (ratio * ratio) * congruence(micro, transpose(p_out))};
}

/// Refraction by a rough surface, by the lobe's peak; see `refraction_pair`. For the exact pair of
/// Snell's law h is the normal and this is `refract` and a convolution.
template <std::floating_point T>
[[nodiscard]] LightField<T> refract_glossy(const LightField<T>& field,
                                           const Surface<NonDeduced<T>>& surface,
                                           const Vec3<NonDeduced<T>>& outgoing, NonDeduced<T> n1,
                                           NonDeduced<T> n2,
                                           const Sym2<NonDeduced<T>>& micro) noexcept {
    return scatter(field, refraction_pair(field.frame, surface, outgoing, n1, n2, micro));
}

}  // namespace covariance
