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

/// Refraction by a rough surface: the map about the microfacet that refracts one direction into the
/// other, h along n1 Zi - n2 Zo, then convolution with (n2/Gamma)^2 P_h Cm P_h^T.
///
/// For the exact pair of Snell's law h is the normal and this is `refract` and a convolution.
/// Shapes   micro: slope covariance in surface.t1, t2.
/// Errors   none; where the interface does not bend the light nothing is convolved.
template <std::floating_point T>
[[nodiscard]] LightField<T> refract_glossy(const LightField<T>& field,
                                           const Surface<NonDeduced<T>>& surface,
                                           const Vec3<NonDeduced<T>>& outgoing, NonDeduced<T> n1,
                                           NonDeduced<T> n2,
                                           const Sym2<NonDeduced<T>>& micro) noexcept {
    const Vec3<T> h = normalized_or(n1 * field.frame.z - n2 * outgoing, surface.n);
    const Surface<T> facet = tilted(surface, h);
    const LightField<T> bent = refract(field, facet, outgoing, n1, n2);
    const T cos_i = std::abs(dot(h, field.frame.z)), cos_t = std::abs(dot(h, outgoing));
    const T gamma = n2 * cos_t - n1 * cos_i;
    if (std::abs(gamma) < T(1e-6) * n2) return bent;
    const Mat2<T> p_out = surface_projection(bent.frame, facet);
    return convolve_angular(bent, refraction_cov<T>(micro, p_out, cos_i, cos_t, n1, n2));
}

}  // namespace covariance
