// Participating media: absorption along a ray and scattering at a point of a volume. Derived in
// covariance/RULES.md, section 6. Belcour, Bala and Soler 2014, "A local frequency analysis of
// light scattering and absorption", have operators for the power spectrum; these are for amplitude.
#pragma once

#include <array>

#include "covariance/local_lobe.hpp"
#include "covariance/reflection.hpp"

namespace covariance {

/// Gradient of the optical depth over (x, y, u, v, t): 1/m, 1/rad, 1/s.
template <std::floating_point T>
using DepthGradient = std::array<T, 5>;

/// Multiplies the light by exp(-tau) where the optical depth tau changes over the neighbours: Sigma
/// += g g^T/(4 pi^2), g = grad tau, as for a signal that changes by its own size over 1/|g|.
///
/// A depth that is the same for all neighbours changes nothing: absorption alone has no frequency.
template <std::floating_point T>
[[nodiscard]] constexpr SymmetricMatrix5<T> absorb(
    SymmetricMatrix5<T> s, const DepthGradient<NonDeduced<T>>& gradient) noexcept {
    for (std::size_t i = 0; i < 5; ++i)
        for (std::size_t j = i; j < 5; ++j) s(i, j) += gradient[i] * gradient[j] / four_pi_sq<T>;
    return s;
}

/// Gradient of the depth of a homogeneous medium between two borders, at the second one.
///
/// A neighbour meets a plane of normal n later by -(q.n)/(Z.n), q its offset there; at the first
/// border, `distance` earlier, its offset is x - distance u.
/// Shapes   n_in, n_out: normals of the borders where light enters and leaves, either side; frame:
///          at the second border. A segment that starts or ends inside the medium has, at that
///          end, the plane across the ray: n = frame.z.
/// Units    extinction in 1/scene unit. |cos| of a border below 0.02 counts as 0.02.
template <std::floating_point T>
[[nodiscard]] DepthGradient<T> slab_gradient(const Frame<T>& frame, const Vec3<NonDeduced<T>>& n_in,
                                             const Vec3<NonDeduced<T>>& n_out,
                                             NonDeduced<T> distance,
                                             NonDeduced<T> extinction) noexcept {
    const auto later = [&](const Vec3<T>& n, const Vec3<T>& axis) {
        const T c = dot(frame.z, n);
        return -extinction * dot(axis, n) /
               std::copysign(std::max(std::abs(c), min_surface_cosine<T>), c);
    };
    const T in_x = -later(n_in, frame.x), in_y = -later(n_in, frame.y);
    return {later(n_out, frame.x) + in_x, later(n_out, frame.y) + in_y, -distance * in_x,
            -distance * in_y, 0};
}

/// Phase function of Henyey and Greenstein 1941, "Diffuse radiation in the galaxy", without its
/// factor (1 - g^2)/(4 pi), for any scalar type: (1 + g^2 - 2 g mu)^(-3/2), mu the cosine of the
/// deflection.
template <std::floating_point T, typename S>
[[nodiscard]] S henyey_greenstein(const S& mu, T g) noexcept {
    using std::pow;
    return pow(S(1 + g * g) - S(2 * g) * mu, T(-1.5));
}

/// Covariance of Henyey and Greenstein's lobe at its peak: 3 |g|/(1 - |g|)^2/(4 pi^2) per axis,
/// 1/rad^2.
template <std::floating_point T>
[[nodiscard]] constexpr Sym2<T> henyey_greenstein_peak(T g) noexcept {
    const T a = g < 0 ? -g : g, c = 3 * a / ((1 - a) * (1 - a) * four_pi_sq<T>);
    return Sym2<T>::diagonal(c, c);
}

/// Scatters light at a point of a volume, by a phase function p(mu) given for jets.
///
/// Positions: a neighbour of the leaving ray starts at x X_o + y Y_o, which the arriving light
/// crosses at P (x, y), P = [X_i.X_o X_i.Y_o; Y_i.X_o Y_i.Y_o]; along the arriving ray nothing
/// changes. Slopes: convolution with the local lobe of p, in the frame turned with the ray (for
/// backward lobes mirrored), the axes in which p depends on the difference of the slopes. No
/// `surface_enter` and `surface_exit` belong to it: both sides are ray coordinates.
///
/// Shapes   peak: covariance at the peak of p, for instance `henyey_greenstein_peak(g)`; backward:
///          whether p has its peak where light turns back.
/// Units    peak in 1/rad^2.
/// Errors   none; P may be singular, which it is for a deflection by 90 degrees.
template <std::floating_point T, typename F>
[[nodiscard]] LightField<T> scatter_in_volume(const LightField<T>& field,
                                              const Vec3<NonDeduced<T>>& outgoing, const F& phase,
                                              const Sym2<NonDeduced<T>>& peak,
                                              bool backward = false) noexcept {
    const Frame<T>& in = field.frame;
    const Frame<T> out =
        backward ? mirrored(in, half_vector(in.z, outgoing, in.x)) : turned_to(in, outgoing);
    const auto f = [&](const JetVec3<T>& wi, const JetVec3<T>& wo) { return phase(-dot(wi, wo)); };
    const auto world = [](const Vec3<T>& v) { return v; };
    const LocalLobe<T> lobe = local_lobe<T>(f, world, in, {out, Mat2<T>::identity(), peak}, {});
    const SymmetricMatrix5<T> moved =
        change_positions(field.sigma, projection(in, out.x, out.y), Mat2<T>{});
    return scatter(LightField<T>{moved, in}, lobe);
}

/// Scatters light by Henyey and Greenstein's phase function of mean cosine g in (-1, 1).
template <std::floating_point T>
[[nodiscard]] LightField<T> scatter_in_volume(const LightField<T>& field,
                                              const Vec3<NonDeduced<T>>& outgoing,
                                              NonDeduced<T> g) noexcept {
    const auto phase = [g](const Jet<T>& mu) { return henyey_greenstein(mu, g); };
    return scatter_in_volume(field, outgoing, phase, henyey_greenstein_peak(g), g < 0);
}

}  // namespace covariance
