// First-order rigid motion of an object, a light or the camera: entering its rest frame turns
// frequencies in space and angle into frequencies in time, leaving it turns them back.
#pragma once

#include <array>

#include "covariance/light_field.hpp"
#include "covariance/matrix5.hpp"

namespace covariance {

/// Motion of a body at one of its points: velocity of that point and angular velocity of the body.
template <std::floating_point T = double>
struct Motion {
    Vec3<T> velocity{};          ///< of the point that is hit, scene units per second
    Vec3<T> angular_velocity{};  ///< radians per second, right-hand rule

    /// Whether the body rests, so that entering and leaving it change nothing.
    [[nodiscard]] constexpr bool at_rest() const noexcept {
        return velocity == Vec3<T>{} && angular_velocity == Vec3<T>{};
    }
};

/// The motion of the point `hit` of a rigid body: V = V_origin + Omega x (hit - origin).
template <std::floating_point T>
[[nodiscard]] constexpr Motion<T> rigid_motion(const Vec3<T>& velocity_of_origin,
                                               const Vec3<NonDeduced<T>>& angular_velocity,
                                               const Vec3<NonDeduced<T>>& origin,
                                               const Vec3<NonDeduced<T>>& hit) noexcept {
    return {velocity_of_origin + cross(angular_velocity, hit - origin), angular_velocity};
}

/// The motion of a deforming surface: point velocity, and Omega = n x dn/dt from its normal.
///
/// The spin about the normal is left out; it matters for anisotropic lobes and textures only.
template <std::floating_point T>
[[nodiscard]] constexpr Motion<T> deforming_motion(
    const Vec3<T>& velocity, const Vec3<NonDeduced<T>>& normal,
    const Vec3<NonDeduced<T>>& normal_derivative) noexcept {
    return {velocity, cross(normal, normal_derivative)};
}

/// Drift of a fixed ray's x, y, u and v: (V.X, V.Y, (Omega x Z).X, (Omega x Z).Y).
template <std::floating_point T>
[[nodiscard]] constexpr std::array<T, 4> drift(const Frame<T>& f,
                                               const Motion<NonDeduced<T>>& m) noexcept {
    const Vec3<T> turn = cross(m.angular_velocity, f.z);
    return {dot(m.velocity, f.x), dot(m.velocity, f.y), dot(turn, f.x), dot(turn, f.y)};
}

/// Old from new coordinates of a drift, p_old = p + a t in x, y, u, v.
template <std::floating_point T>
[[nodiscard]] constexpr Matrix5<T> drift_matrix(const std::array<T, 4>& a) noexcept {
    Matrix5<T> m = Matrix5<T>::identity();
    for (std::size_t i = 0; i < 4; ++i) m(i, axis::t) = a[i];
    return m;
}

/// Applies p_old = p + a t: W_t' = W_t + a.W, all other frequencies unchanged.
template <std::floating_point T>
[[nodiscard]] constexpr SymmetricMatrix5<T> change_time(
    SymmetricMatrix5<T> s, const std::array<NonDeduced<T>, 4>& a) noexcept {
    std::array<T, 4> step{};
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j) step[i] += s(i, j) * a[j];
    for (std::size_t i = 0; i < 4; ++i) s(4, 4) += a[i] * (2 * s(i, 4) + step[i]);
    for (std::size_t i = 0; i < 4; ++i) s(i, 4) += step[i];
    return s;
}

/// Goes into the rest frame of a moving body: x_old = x + (V.X) t, u_old = u + ((Omega x Z).X) t,
/// ...
///
/// Frame    that of the arriving ray; call it before `surface_enter`, and for a moving camera right
///          before the sensor map. Undone by `motion_exit` with the same frame.
/// Errors   none. First order in time.
template <std::floating_point T>
[[nodiscard]] constexpr SymmetricMatrix5<T> motion_enter(
    const SymmetricMatrix5<T>& s, const Frame<NonDeduced<T>>& incoming,
    const Motion<NonDeduced<T>>& motion) noexcept {
    return motion.at_rest() ? s : change_time(s, drift<T>(incoming, motion));
}

/// Brings a light field into the rest frame, with its own frame as the arriving one.
template <std::floating_point T>
[[nodiscard]] constexpr LightField<T> motion_enter(const LightField<T>& field,
                                                   const Motion<NonDeduced<T>>& motion) noexcept {
    return {motion_enter(field.sigma, field.frame, motion), field.frame};
}

/// Goes out of the rest frame of a moving body: the drift of `motion_enter` with the opposite sign.
///
/// Frame    that of the leaving ray; call it after `surface_exit`.
template <std::floating_point T>
[[nodiscard]] constexpr SymmetricMatrix5<T> motion_exit(
    const SymmetricMatrix5<T>& s, const Frame<NonDeduced<T>>& outgoing,
    const Motion<NonDeduced<T>>& motion) noexcept {
    return motion_enter(s, outgoing, {-motion.velocity, -motion.angular_velocity});
}

/// Brings a light field out of the rest frame, with its own frame as the leaving one.
template <std::floating_point T>
[[nodiscard]] constexpr LightField<T> motion_exit(const LightField<T>& field,
                                                  const Motion<NonDeduced<T>>& motion) noexcept {
    return {motion_exit(field.sigma, field.frame, motion), field.frame};
}

/// Old from new coordinates for `motion_enter`.
template <std::floating_point T>
[[nodiscard]] constexpr Matrix5<T> motion_enter_matrix(
    const Frame<T>& f, const Motion<NonDeduced<T>>& motion) noexcept {
    return drift_matrix(drift(f, motion));
}

/// Old from new coordinates for `motion_exit`.
template <std::floating_point T>
[[nodiscard]] constexpr Matrix5<T> motion_exit_matrix(
    const Frame<T>& f, const Motion<NonDeduced<T>>& motion) noexcept {
    return drift_matrix<T>(drift(f, Motion<T>{-motion.velocity, -motion.angular_velocity}));
}

}  // namespace covariance
