// Reflection at a surface: diffuse, glossy, mirror. Called between surface_enter and surface_exit;
// each leaves the light field in the frame of the reflected ray, so that
// surface_exit(field, surface) can follow at once.
//
// Directions are those in which light travels: `outgoing` points away from the surface to the
// camera.
#pragma once

#include "covariance/angular.hpp"
#include "covariance/brdf.hpp"

namespace covariance {

/// Half vector h = (Zo - Zi)/|Zo - Zi|: the normal of the mirror that takes the direction
/// `incoming` into `outgoing`; `fallback` where the two agree.
template <std::floating_point T>
[[nodiscard]] Vec3<T> half_vector(const Vec3<T>& incoming, const Vec3<NonDeduced<T>>& outgoing,
                                  const Vec3<NonDeduced<T>>& fallback) noexcept {
    return normalized_or(outgoing - incoming, fallback);
}

/// The surface turned by the smallest rotation that brings n to the unit vector h or -h, whichever
/// is nearer: the microfacet that takes part in an off-specular pair of directions.
template <std::floating_point T>
[[nodiscard]] Surface<T> tilted(const Surface<T>& s, const Vec3<NonDeduced<T>>& h) noexcept {
    const Vec3<T> to = dot(s.n, h) < 0 ? -h : h;
    return {to, rotate_between<T>(s.n, to, s.t1), rotate_between<T>(s.n, to, s.t2), s.curvature};
}

/// Reflects light by a perfect mirror; every other reflection changes its frame in this way, too.
/// The axes are reflected in the plane orthogonal to the half vector, and with these axes the
/// covariance stays as it is, also for directions off the mirror direction. The new frame has the
/// other handedness.
template <std::floating_point T>
[[nodiscard]] LightField<T> reflect_specular(const LightField<T>& field,
                                             const Surface<NonDeduced<T>>& surface,
                                             const Vec3<NonDeduced<T>>& outgoing) noexcept {
    return {field.sigma, mirrored(field.frame, half_vector(field.frame.z, outgoing, surface.n))};
}

/// Reflection by any lobe: mirrored frame, then convolution with the covariance C of the lobe.
///
/// Units    C in 1/rad^2, in outgoing slopes along the mirrored X, Y; for an isotropic lobe such as
///          `phong_cov(e)` the axes do not matter.
template <std::floating_point T>
[[nodiscard]] LightField<T> reflect_lobe(const LightField<T>& field,
                                         const Surface<NonDeduced<T>>& surface,
                                         const Vec3<NonDeduced<T>>& outgoing,
                                         const Sym2<NonDeduced<T>>& lobe) noexcept {
    return convolve_angular(reflect_specular(field, surface, outgoing), lobe);
}

/// Covariance C of a microfacet lobe along the axes of `reflected`, a frame mirrored about h.
template <std::floating_point T>
[[nodiscard]] Sym2<T> glossy_lobe(const Frame<T>& reflected, const Surface<NonDeduced<T>>& surface,
                                  const Vec3<NonDeduced<T>>& h,
                                  const Sym2<NonDeduced<T>>& micro) noexcept {
    const T cos_h = std::max(std::abs(dot(h, reflected.z)), min_surface_cosine<T>);
    if (micro.xx == micro.yy && micro.xy == 0) {
        // All tangents are alike: with P^T P of h's own, it is I minus the outer product of h's
        // components along X and Y.
        const T scale = micro.xx / (4 * cos_h * cos_h);
        const T x = dot(reflected.x, h), y = dot(reflected.y, h);
        return {scale * (1 - x * x), -scale * x * y, scale * (1 - y * y)};
    }
    return reflection_cov<T>(micro, surface_projection<T>(reflected, tilted<T>(surface, h)), cos_h);
}

/// A pair of directions that a rough surface joins: the frame of the leaving ray, the map of the
/// slopes (arriving from leaving) and the covariance of the lobe in leaving slopes, at its peak.
template <std::floating_point T = double>
struct GlossyPair {
    Frame<T> outgoing;
    Mat2<T> map = Mat2<T>::identity();
    Sym2<T> lobe;
};

/// The pair of directions of a reflection: mirrored frame, no map, lobe P_h Cm P_h^T / (4
/// (h.Zo)^2).
///
/// Shapes   micro: slope covariance in surface.t1, t2, from `micro_beckmann`, `micro_ggx`, ...
/// Errors   none; |h.Zo| below 0.02 counts as 0.02. The lobe's own error against the true
///          distribution is at most 1e-3 at the peak and 3 to 12 % a quarter radian off it.
template <std::floating_point T>
[[nodiscard]] GlossyPair<T> reflection_pair(const Frame<T>& incoming,
                                            const Surface<NonDeduced<T>>& surface,
                                            const Vec3<NonDeduced<T>>& outgoing,
                                            const Sym2<NonDeduced<T>>& micro) noexcept {
    const Vec3<T> h = half_vector(incoming.z, outgoing, surface.n);
    const Frame<T> frame = mirrored(incoming, h);
    return {frame, Mat2<T>::identity(), glossy_lobe(frame, surface, h, micro)};
}

/// Sends light through a pair: map of the slopes, then convolution with the lobe.
template <std::floating_point T>
[[nodiscard]] LightField<T> scatter(const LightField<T>& field,
                                    const GlossyPair<NonDeduced<T>>& pair) noexcept {
    return {convolve_angular(map_angular(field.sigma, pair.map), pair.lobe), pair.outgoing};
}

/// Reflection by a rough surface, by the lobe's peak; see `reflection_pair`.
template <std::floating_point T>
[[nodiscard]] LightField<T> reflect_glossy(const LightField<T>& field,
                                           const Surface<NonDeduced<T>>& surface,
                                           const Vec3<NonDeduced<T>>& outgoing,
                                           const Sym2<NonDeduced<T>>& micro) noexcept {
    return scatter(field, reflection_pair(field.frame, surface, outgoing, micro));
}

/// Reflects light by a fuzzy mirror (brushed metal as in small path tracers): the mirror direction
/// plus a random vector from the ball of radius `fuzz`; see `fuzz_cov`. For microfacets use
/// `reflect_glossy`.
///
/// Errors   none; without fuzz it is `reflect_specular`.
template <std::floating_point T>
[[nodiscard]] LightField<T> reflect_fuzzy(const LightField<T>& field,
                                          const Surface<NonDeduced<T>>& surface,
                                          const Vec3<NonDeduced<T>>& outgoing,
                                          NonDeduced<T> fuzz) noexcept {
    if (!(fuzz > 0)) return reflect_specular(field, surface, outgoing);
    return reflect_lobe(field, surface, outgoing, fuzz_cov<T>(fuzz));
}

/// Multiplies the arriving light by the cosine of its angle with the normal (see `cosine_window`).
///
/// Part of `reflect_diffuse`; call it yourself before a glossy lobe so wide (alpha above about 0.4)
/// that the hemisphere cuts it.
template <std::floating_point T>
[[nodiscard]] LightField<T> add_cosine_window(const LightField<T>& field,
                                              const Surface<NonDeduced<T>>& surface) noexcept {
    return add_angular_window(field, cosine_window(field.frame, surface.n));
}

/// Lambertian reflection or transmission: cosine window, then integration over all arriving
/// directions. Rows u and v become exactly zero, so any frame along `outgoing` may follow.
template <std::floating_point T>
[[nodiscard]] LightField<T> reflect_diffuse(const LightField<T>& field,
                                            const Surface<NonDeduced<T>>& surface,
                                            const Vec3<NonDeduced<T>>& outgoing) noexcept {
    const LightField<T> windowed = add_cosine_window(field, surface);
    return {slice_angular(windowed.sigma), frame_along<T>(outgoing)};
}

}  // namespace covariance
