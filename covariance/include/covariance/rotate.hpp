// Other transverse axes for the same ray: rotation, reflection of one axis, any new pair X', Y'.
#pragma once

#include <cmath>

#include "covariance/light_field.hpp"
#include "covariance/matrix5.hpp"

namespace covariance {

/// Old from new coordinates where (x, y) = Q (x', y') and (u, v) = Q (u', v').
template <std::floating_point T>
[[nodiscard]] constexpr Matrix5<T> transverse_matrix(const Mat2<T>& q) noexcept {
    return Matrix5<T>::identity().set_block(0, 0, q).set_block(2, 2, q);
}

/// Applies the same 2x2 map Q (old from new) to positions and slopes: blockdiag(Q, Q, 1).
template <std::floating_point T>
[[nodiscard]] constexpr SymmetricMatrix5<T> change_transverse(
    const SymmetricMatrix5<T>& old, const Mat2<NonDeduced<T>>& q) noexcept {
    SymmetricMatrix5<T> s = old;
    s.set_spatial(congruence(s.spatial(), q));
    s.set_angular(congruence(s.angular(), q));
    s.set_cross(transpose(q) * s.cross() * q);
    for (const std::size_t i : {axis::x, axis::u}) {
        const T a = s(i, 4), b = s(i + 1, 4);
        s(i, 4) = sum_of_products(q.m00, a, q.m10, b);
        s(i + 1, 4) = sum_of_products(q.m01, a, q.m11, b);
    }
    return s;
}

/// Matrix Q of a rotation by alpha: X' = cos X + sin Y, Y' = -sin X + cos Y; alpha in radians.
template <std::floating_point T>
[[nodiscard]] Mat2<T> rotation(T alpha) noexcept {
    const T c = std::cos(alpha), s = std::sin(alpha);
    return {c, -s, s, c};
}

/// Expresses the covariance along axes turned by alpha: X' = cos X + sin Y, Y' = -sin X + cos Y.
///
/// Units    alpha in radians. Composes: the angles add. Errors: none.
template <std::floating_point T>
[[nodiscard]] SymmetricMatrix5<T> rotate(const SymmetricMatrix5<T>& s,
                                         NonDeduced<T> alpha) noexcept {
    return change_transverse(s, rotation<T>(alpha));
}

/// Rotates the axes of a light field, whose frame turns along.
template <std::floating_point T>
[[nodiscard]] LightField<T> rotate(const LightField<T>& field, NonDeduced<T> alpha) noexcept {
    const T c = std::cos(alpha), s = std::sin(alpha);
    const Frame<T>& f = field.frame;
    return {rotate(field.sigma, alpha), {c * f.x + s * f.y, c * f.y - s * f.x, f.z}};
}

/// Reverses Y: the signs of all entries that pair y or v with x, u or t.
///
/// Changes between a mirrored (left-handed) frame and a right-handed one; is its own inverse.
template <std::floating_point T>
[[nodiscard]] constexpr SymmetricMatrix5<T> flip_y(SymmetricMatrix5<T> s) noexcept {
    for (const std::size_t i : {axis::y, axis::v})
        for (const std::size_t j : {axis::x, axis::u, axis::t}) s(i, j) = -s(i, j);
    return s;
}

/// Reverses Y of a light field and of its frame.
template <std::floating_point T>
[[nodiscard]] constexpr LightField<T> flip_y(const LightField<T>& field) noexcept {
    return {flip_y(field.sigma), {field.frame.x, -field.frame.y, field.frame.z}};
}

/// Expresses the light field in another frame with the same Z: Q = [X.X' X.Y'; Y.X' Y.Y'].
///
/// Pre      frame.z equals field.frame.z; X', Y' are orthonormal, of either handedness.
/// Post     the light field itself is the same, only its description changed.
template <std::floating_point T>
[[nodiscard]] constexpr LightField<T> rotate_to(const LightField<T>& field,
                                                const Frame<NonDeduced<T>>& frame) noexcept {
    if (field.frame.x == frame.x && field.frame.y == frame.y) return field;
    return {change_transverse(field.sigma, projection(field.frame, frame.x, frame.y)), frame};
}

}  // namespace covariance
