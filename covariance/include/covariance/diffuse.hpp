// Diffuse reflection of light whose emitter is known. `cosine_window` (brdf.hpp) knows the angle of
// incidence alone, which is enough for a distant emitter. A near one is also seen larger and
// steeper as the receiver comes closer, and past about 45 degrees of incidence the bandwidth
// follows from that falloff, not from the cosine: at 75 degrees it is 2.4 times what
// `cosine_window` says.
//
// A small Lambertian emitter with the normal m at the unit distance in the direction d lights the
// tangential displacement p of the receiver by
//
//   E(p) = (n.d) (m.(p - d)) / |d - p|^4,      Hess E / E = 24 a a^T - 4 I - 4 (a b^T + b a^T)
//
// with z = -d, and a = z, b = m/(m.z) in tangent coordinates; one that shines evenly (a sphere, a
// point) by |d - p|^-3, with 15 a a^T - 3 I. These are the exact second derivatives.
#pragma once

#include <cmath>
#include <limits>

#include "covariance/reflection.hpp"

namespace covariance {

/// The place where arriving light was sent out, as far as it changes how fast the light falls off:
/// the lamp that was sampled, or that a path found by chance. In a flat mirror the lamp's mirror
/// image counts, with its normal mirrored and the distance along the whole way; behind curved
/// mirrors and glass leave both members as they are.
template <std::floating_point T = double>
struct Emitter {
    /// Unit normal of a Lambertian emitter, on either side; zero for one that shines evenly.
    Vec3<T> normal{};
    /// Straight distance from the receiver, in scene units; infinite for a sky or a sun.
    T distance = std::numeric_limits<T>::infinity();
};

/// Peak of -Hess E / E, right below a small emitter at the unit distance: 4 for a Lambertian one, 3
/// for one that shines evenly.
template <std::floating_point T>
[[nodiscard]] constexpr T falloff_peak(const Vec3<T>& emitter_normal) noexcept {
    return dot(emitter_normal, emitter_normal) > 0 ? T(4) : T(3);
}

/// Squared bandwidth, times 4 pi^2, on the tangent plane, of the light that a small emitter at the
/// unit distance casts; `falloff_peak` right below the emitter.
///
/// Along the direction in which H = Hess E / E has its highest eigenvalue h it is
///
///     f1 = max(peak (1 - sin^2(theta)/2), -h, 1.5 (h - peak)),    theta the angle of incidence,
///
/// a fit to what a Gaussian window of the size that follows from it sees of E, from the peak
/// through the point of inflection, where h alone would be 0, out to the flank. Across it, where H
/// has the eigenvalue l and E the third derivative t E (twice across, once along), it is
///
///     sqrt(max(peak, -l)^2 + t^2 / (4 f1)),
///
/// l and its change over that window, root mean square. Within 15 % on the bandwidth of the exact
/// kernel (docs/decisions/0010-diffuse-falloff.md).
///
/// Shapes   symmetric 2x2 along receiver.t1, t2.
/// Frame    of the arriving light, z from the emitter.
/// Errors   none; the emission cosine counts as at least 0.05.
template <std::floating_point T>
[[nodiscard]] Sym2<T> falloff_bandwidth(const Frame<T>& incoming,
                                        const Surface<NonDeduced<T>>& receiver,
                                        const Vec3<NonDeduced<T>>& emitter_normal) noexcept {
    const bool even = !(dot(emitter_normal, emitter_normal) > 0);
    const T peak = falloff_peak<T>(emitter_normal);
    const T a1 = dot(incoming.z, receiver.t1), a2 = dot(incoming.z, receiver.t2);
    T b1 = 0, b2 = 0;  // gradient of the emission cosine, 1 + b.s
    if (!even) {
        const T c = dot(emitter_normal, incoming.z);
        const T scale = 1 / std::copysign(std::max(std::abs(c), min_window_cosine<T>), c);
        b1 = scale * dot(emitter_normal, receiver.t1);
        b2 = scale * dot(emitter_normal, receiver.t2);
    }
    // The factor |p - d|^-2n, n = 2 or 3/2, has the gradient -2n a and the Hessian 4n(n + 1) a a^T
    // - 2n I.
    const T second = peak * (peak + 2);
    const Sym2<T> hessian{second * a1 * a1 - peak - 2 * peak * a1 * b1,
                          second * a1 * a2 - peak * (a1 * b2 + a2 * b1),
                          second * a2 * a2 - peak - 2 * peak * a2 * b2};
    const Eigen2<T> e = eigen(hessian);
    const T sin_sq = std::min(a1 * a1 + a2 * a2, T(1));
    const T high = std::max(std::max(peak * (1 - sin_sq / 2), -e.high), T(1.5) * (e.high - peak));
    // The third derivative, twice across and once along, is 4n(n + 1) a - 2n b along e, up to terms
    // with the components of a and b across it.
    const T along_a = e.x * a1 + e.y * a2, along_b = e.x * b1 + e.y * b2;
    const T third = second * along_a - peak * along_b;
    const T across = std::max(peak, -e.low);
    const T low = std::sqrt(across * across + third * third / (4 * high));
    return {high * e.x * e.x + low * e.y * e.y, (high - low) * e.x * e.y,
            high * e.y * e.y + low * e.x * e.x};
}

/// The angular window of diffuse reflection for light from an emitter, in place of `cosine_window`,
/// which knows nothing but the direction of the light.
///
/// The weight of a direction, (1 + u^2 + v^2)^-2, has the tails of `tailed_lobe`. Over a tangent
/// displacement s the direction to an emitter at the distance D turns by s/D, the normal of a
/// receiver of curvature k by k s; only the share (1 + |k| D)^-2 of the difference between the
/// falloff and the cosine is added.
///
/// Frames   incoming: of the arriving light. light: its angular covariance in that frame, between
///          `surface_enter` and the integral over directions.
/// Errors   none; cosines below 0.05 count as 0.05 where the light is distant, elsewhere those
///          below 0.02 as 0.02.
template <std::floating_point T>
[[nodiscard]] Sym2<T> diffuse_window(const Frame<T>& incoming,
                                     const Surface<NonDeduced<T>>& receiver,
                                     const Emitter<NonDeduced<T>>& emitter,
                                     const Sym2<NonDeduced<T>>& light) noexcept {
    const Sym2<T> distant = cosine_window(incoming, receiver.n);
    const Sym2<T> seen = tailed_lobe(distant, light);
    if (!std::isfinite(emitter.distance)) return seen;
    // A displacement s changes the slope by P s / D: the window of the falloff F is P^-T F P^-1.
    const Sym2<T> falloff =
        (1 / four_pi_sq<T>)*falloff_bandwidth(incoming, receiver, emitter.normal);
    const Sym2<T> near = congruence(falloff, inverse_projection(incoming, receiver));
    if (receiver.curvature == Sym2<T>{}) return seen + (near - distant);
    const Eigen2<T> k = eigen(receiver.curvature);
    const T turn = 1 + std::max(std::abs(k.high), std::abs(k.low)) * emitter.distance;
    return seen + (1 / (turn * turn)) * (near - distant);
}

/// Lambertian reflection or transmission of light whose emitter is known.
template <std::floating_point T>
[[nodiscard]] LightField<T> reflect_diffuse(const LightField<T>& field,
                                            const Surface<NonDeduced<T>>& surface,
                                            const Vec3<NonDeduced<T>>& outgoing,
                                            const Emitter<NonDeduced<T>>& emitter) noexcept {
    const Sym2<T> window = diffuse_window(field.frame, surface, emitter, field.sigma.angular());
    return {slice_angular(add_angular_window(field.sigma, window)), frame_along<T>(outgoing)};
}

}  // namespace covariance
