// Diffuse reflection of light whose emitter is known. `cosine_window` (brdf.hpp) knows the angle of
// incidence alone and takes the light of a distant emitter exactly; a near one is also seen larger
// and steeper as the receiver comes closer, and past about 45 degrees of incidence that falloff,
// not the cosine, is what bounds the bandwidth: up to 2.4 times in the plane of incidence.
//
// A small Lambertian emitter with the normal m at the unit distance in the direction d lights the
// tangential displacement s of the receiver, p = T^T s, by
//
//   E(s) = (n.d) (m.(p - d)) / |d - p|^4,      Hess E / E = 24 a a^T - 4 I - 4 (a b^T + b a^T)/(m.z)
//
// with z = -d, a = T^T z, b = T^T m; one that shines evenly (a sphere, a point) by |d - p|^-3, with
// 15 a a^T - 3 I. These are the exact second derivatives. `falloff_bandwidth` makes a bandwidth of
// them.
#pragma once

#include <cmath>
#include <limits>

#include "covariance/reflection.hpp"

namespace covariance {

/// Where arriving light was sent out, as far as it changes how fast the light falls off.
template <std::floating_point T = double>
struct Emitter {
    /// Unit normal of a Lambertian emitter, on either side; zero for one that shines evenly.
    Vec3<T> normal{};
    /// Straight distance from the receiver, in scene units; infinite for a sky or a sun.
    T distance = std::numeric_limits<T>::infinity();
};

/// Hess E / E of the light that a small emitter at the unit distance casts on the tangent plane.
///
/// Shapes   symmetric 2x2 along receiver.t1, t2. Frame the arriving one; z from the emitter.
/// Errors   none; the emission cosine counts as at least 0.05.
template <std::floating_point T>
[[nodiscard]] Sym2<T> falloff_hessian(const Frame<T>& incoming,
                                      const Surface<NonDeduced<T>>& receiver,
                                      const Vec3<NonDeduced<T>>& emitter_normal) noexcept {
    const T a1 = dot(incoming.z, receiver.t1), a2 = dot(incoming.z, receiver.t2);
    if (!(dot(emitter_normal, emitter_normal) > 0))
        return {15 * a1 * a1 - 3, 15 * a1 * a2, 15 * a2 * a2 - 3};
    const T c = dot(emitter_normal, incoming.z);
    const T scale = -4 / std::copysign(std::max(std::abs(c), min_window_cosine<T>), c);
    const T b1 = dot(emitter_normal, receiver.t1), b2 = dot(emitter_normal, receiver.t2);
    return {24 * a1 * a1 - 4 + 2 * scale * a1 * b1, 24 * a1 * a2 + scale * (a1 * b2 + a2 * b1),
            24 * a2 * a2 - 4 + 2 * scale * a2 * b2};
}

/// 4 pi^2 times the bandwidth, squared, of light with the relative second derivative h, where the
/// peak of the falloff has -peak.
///
/// About a maximum (h < 0) it is -h. On the flank it is what a Gaussian of the size that follows
/// from it sees, the fourth derivative included: nothing near the point of inflection, so that
/// `peak` remains, and 1.5 (h - peak) far out. Within 15 % on the bandwidth of the exact kernel, for
/// emitters parallel to the receiver and facing it (docs/decisions/0010).
template <std::floating_point T>
[[nodiscard]] constexpr T falloff_bandwidth(T h, NonDeduced<T> peak) noexcept {
    return std::max(peak, h < 0 ? -h : T(1.5) * (h - peak));
}

/// The angular window of diffuse reflection for light from an emitter: what `cosine_window` is for
/// a distant one, and up to 45 degrees for all Lambertian ones.
///
/// Frames   incoming: of the arriving light; between `surface_enter` and the slice.
/// A receiver of curvature k turns against the light by k s beside the s/D of the emitter; only the
/// part of the parallax, (1 + |k| D)^-2, gets the falloff.
/// Errors   none; cosines below 0.02 count as 0.02.
template <std::floating_point T>
[[nodiscard]] Sym2<T> diffuse_window(const Frame<T>& incoming,
                                     const Surface<NonDeduced<T>>& receiver,
                                     const Emitter<NonDeduced<T>>& emitter) noexcept {
    const Sym2<T> distant = cosine_window(incoming, receiver.n);
    if (!std::isfinite(emitter.distance)) return distant;
    const T peak = dot(emitter.normal, emitter.normal) > 0 ? T(4) : T(3);
    const Sym2<T> falloff =
        map_eigenvalues(falloff_hessian(incoming, receiver, emitter.normal),
                        [=](T h) { return falloff_bandwidth(h, peak) / four_pi_sq<T>; });
    // A displacement s changes the slope by P s / D: the window is P^-T F P^-1.
    const Sym2<T> near = congruence(falloff, inverse_projection(incoming, receiver));
    const Eigen2<T> k = eigen(receiver.curvature);
    const T turn = 1 + std::max(std::abs(k.high), std::abs(k.low)) * emitter.distance;
    const T share = 1 / (turn * turn);
    return share * near + (1 - share) * distant;
}

/// A lobe of the shape (1 + r^2/a^2)^-2, which falls off more slowly than the Gaussian of its peak,
/// as light of the angular covariance `light` finds it: C' with C'^-1 = C^-1 + (C + light)^-1.
///
/// Light that smooths the lobe by a variance S far below the lobe's own takes its peak down by 2 S,
/// where a Gaussian's would fall by S (from the Taylor series of the lobe); for S as large as the
/// lobe the excess stays behind. Sharp light leaves C as it is, even light halves it. Within 2 % of
/// the exact bandwidth up to S equal to the lobe's, and above it (never below) from there on.
/// Shapes   both in the same axes; units 1/rad^2; C positive definite.
template <std::floating_point T>
[[nodiscard]] constexpr Sym2<T> tailed_lobe(const Sym2<T>& c,
                                            const Sym2<NonDeduced<T>>& light) noexcept {
    return inverse(inverse(c) + inverse(c + light));
}

/// Lambertian reflection or transmission of light whose emitter is known.
template <std::floating_point T>
[[nodiscard]] LightField<T> reflect_diffuse(const LightField<T>& field,
                                            const Surface<NonDeduced<T>>& surface,
                                            const Vec3<NonDeduced<T>>& outgoing,
                                            const Emitter<NonDeduced<T>>& emitter) noexcept {
    // The weight of a direction, (1 + u^2 + v^2)^-2, has the shape of that lobe.
    const Sym2<T> window =
        tailed_lobe(diffuse_window(field.frame, surface, emitter), field.sigma.angular());
    return {convolve_angular(add_angular_window(field.sigma, window), Sym2<T>{}),
            frame_along<T>(outgoing)};
}

}  // namespace covariance
