// Frame: the explicit axes of a ray. Z is the direction in which light travels; X, Y are unit
// vectors orthogonal to it. After a mirror the pair is left-handed, and stays so: nothing here ever
// recomputes Y from Z and X.
#pragma once

#include <cmath>

#include "covariance/sym2.hpp"

namespace covariance {

/// The axes of a local light field in world space.
///
/// A neighbouring ray (x, y, u, v) crosses the plane through the central point at
/// C + x X + y Y and has the direction Z + u X + v Y.
template <std::floating_point T = double>
struct Frame {
    Vec3<T> x{1, 0, 0};
    Vec3<T> y{0, 1, 0};
    Vec3<T> z{0, 0, 1};  ///< direction of the light, from the emitter to the camera

    friend constexpr bool operator==(const Frame&, const Frame&) noexcept = default;
};

/// Some right-handed frame with the given unit direction as Z (Duff et al. 2017, "Building an
/// orthonormal basis, revisited").
template <std::floating_point T = double>
[[nodiscard]] Frame<T> frame_along(const Vec3<NonDeduced<T>>& z) noexcept {
    // The sign of z.z gives the denominator sign + z.z a size of at least 1.
    const T sign = std::copysign(T(1), z.z);
    const T a = -1 / (sign + z.z);
    const T b = z.x * z.y * a;
    return {{1 + sign * z.x * z.x * a, sign * b, -sign * z.x}, {b, sign + z.y * z.y * a, -z.y}, z};
}

/// The frame reflected in the plane orthogonal to the unit vector `h`: (I - 2 h h^T) X, Y, Z.
template <std::floating_point T>
[[nodiscard]] constexpr Frame<T> mirrored(const Frame<T>& f,
                                          const Vec3<NonDeduced<T>>& h) noexcept {
    return {add_scaled(f.x, -2 * dot(f.x, h), h), add_scaled(f.y, -2 * dot(f.y, h), h),
            add_scaled(f.z, -2 * dot(f.z, h), h)};
}

/// The frame turned by the smallest rotation that brings its Z to the unit vector `z`.
///
/// This is the natural frame after a refraction: an axis orthogonal to the plane of incidence
/// stays.
template <std::floating_point T>
[[nodiscard]] Frame<T> turned_to(const Frame<T>& f, const Vec3<NonDeduced<T>>& z) noexcept {
    return {rotate_between<T>(f.z, z, f.x), rotate_between<T>(f.z, z, f.y), z};
}

/// Coordinates of the vectors a and b in the frame: [X.a X.b; Y.a Y.b].
template <std::floating_point T>
[[nodiscard]] constexpr Mat2<T> projection(const Frame<T>& f, const Vec3<NonDeduced<T>>& a,
                                           const Vec3<NonDeduced<T>>& b) noexcept {
    return {dot(f.x, a), dot(f.x, b), dot(f.y, a), dot(f.y, b)};
}

}  // namespace covariance
