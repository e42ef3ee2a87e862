// Scalars: constants, the tolerance and the sums of products that the other headers share.
#pragma once

#if __cplusplus < 202002L && (!defined(_MSVC_LANG) || _MSVC_LANG < 202002L)
#error "covariance needs C++20: compile with -std=c++20 (MSVC: /std:c++20) or newer"
// The missing file ends the compilation; thousands of errors would follow the one above.
#include "covariance_needs_cxx20"
#endif

#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>
#include <numbers>
#include <type_traits>

namespace covariance {

/// The circle constant in the scalar type of the caller.
template <std::floating_point T>
inline constexpr T pi = std::numbers::pi_v<T>;

/// 4 pi^2, the factor between a frequency covariance and the inverse of a primal one: S = (4 pi^2
/// Sigma)^-1.
template <std::floating_point T>
inline constexpr T four_pi_sq = 4 * std::numbers::pi_v<T>* std::numbers::pi_v<T>;

/// A parameter type that takes no part in template argument deduction, so that `travel(field, 2)`
/// works for fields of float and of double alike.
template <typename T>
using NonDeduced = std::type_identity_t<T>;

/// Relative size below which a difference of covariances counts as rounding noise:
/// 1e-13 in double, 16 machine epsilons in float.
template <std::floating_point T>
inline constexpr T noise_level = std::max(T(1e-13), 16 * std::numeric_limits<T>::epsilon());

/// The value a b + c, rounded once where the processor does both in one instruction, which is also
/// half of the work; in constant expressions always rounded twice. Which of the two is decided when
/// the code is compiled, so that the same program always gives the same bits, inlined or not.
template <std::floating_point T>
[[nodiscard]] constexpr T multiply_add(T a, NonDeduced<T> b, NonDeduced<T> c) noexcept {
#ifdef __FMA__
    if (!std::is_constant_evaluated()) return std::fma(a, b, c);
#endif
    return a * b + c;
}

/// The value a b + c d.
template <std::floating_point T>
[[nodiscard]] constexpr T sum_of_products(T a, NonDeduced<T> b, NonDeduced<T> c,
                                          NonDeduced<T> d) noexcept {
    return multiply_add(a, b, c * d);
}

}  // namespace covariance
