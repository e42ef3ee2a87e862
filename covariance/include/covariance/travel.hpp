// Travel through free space: position frequencies flow into slope frequencies, W_u' = W_u - d W_x.
// Exact, because slopes (not angles) are linear along a ray. Light takes no time.
#pragma once

#include "covariance/light_field.hpp"
#include "covariance/matrix5.hpp"

namespace covariance {

/// Old from new coordinates for `travel`: x_old = x - d u, y_old = y - d v.
template <std::floating_point T>
[[nodiscard]] constexpr Matrix5<T> travel_matrix(T distance) noexcept {
    Matrix5<T> a = Matrix5<T>::identity();
    a(axis::x, axis::u) = a(axis::y, axis::v) = -distance;
    return a;
}

/// Whether nothing varies with the position across the ray: such light is the same after any way.
template <std::floating_point T>
[[nodiscard]] constexpr bool is_even_in_space(const SymmetricMatrix5<T>& s) noexcept {
    return s.spatial() == Sym2<T>{} && s.cross() == Mat2<T>{} && s(0, 4) == 0 && s(1, 4) == 0;
}

/// Carries the light over a distance of free space.
///
///     Sxu' = Sxu - d Sxx      Suu' = Suu - 2 d Sxu + d^2 Sxx      Sut' = Sut - d Sxt, and so on
///
/// Composes: travel(a) then travel(b) is travel(a + b); travel(-a) undoes travel(a).
/// Units    distance in scene units, any sign; infinite for light from infinity that meets nothing
///          on its way: without variation in space (Sxx = Sxu = 0) it stays as it is.
/// Frame    unchanged.
/// Post     det unchanged, positive semi-definite where the input is.
/// Errors   none; NaN in gives NaN out.
template <std::floating_point T>
[[nodiscard]] constexpr SymmetricMatrix5<T> travel(const SymmetricMatrix5<T>& old,
                                                   NonDeduced<T> distance) noexcept {
    SymmetricMatrix5<T> s = old;
    const T d = distance;
    const bool is_infinite =
        d > std::numeric_limits<T>::max() || d < -std::numeric_limits<T>::max();
    if (is_infinite && is_even_in_space(s)) return s;
    const auto subtract = [&](std::size_t i, std::size_t j, T a) {
        s(i, j) = multiply_add(-d, a, s(i, j));
    };
    subtract(2, 2, multiply_add(-d, s(0, 0), 2 * s(0, 2)));
    subtract(2, 3, multiply_add(-d, s(0, 1), s(0, 3) + s(1, 2)));
    subtract(3, 3, multiply_add(-d, s(1, 1), 2 * s(1, 3)));
    subtract(0, 2, s(0, 0));
    subtract(0, 3, s(0, 1));
    subtract(1, 2, s(0, 1));
    subtract(1, 3, s(1, 1));
    subtract(2, 4, s(0, 4));
    subtract(3, 4, s(1, 4));
    return s;
}

/// Carries a light field over a distance; its frame is unchanged.
template <std::floating_point T>
[[nodiscard]] constexpr LightField<T> travel(const LightField<T>& field,
                                             NonDeduced<T> distance) noexcept {
    return {travel(field.sigma, distance), field.frame};
}

}  // namespace covariance
