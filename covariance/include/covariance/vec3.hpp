// Three-vectors: a minimal type of our own, and the concept through which any vector type of the
// caller with members x, y, z, or functions of these names, is accepted wherever a Vec3 is asked
// for.
#pragma once

#include <cmath>

#include "covariance/scalar.hpp"

namespace covariance {

/// Any type with numeric members `x`, `y`, `z`; converts implicitly to `Vec3`.
template <typename V>
concept Vec3Like = requires(const V& v) {
    { v.x } -> std::convertible_to<double>;
    { v.y } -> std::convertible_to<double>;
    { v.z } -> std::convertible_to<double>;
};

/// Any type with numeric member functions `x()`, `y()`, `z()`; converts as well.
template <typename V>
concept Vec3LikeByFunctions = requires(const V& v) {
    { v.x() } -> std::convertible_to<double>;
    { v.y() } -> std::convertible_to<double>;
    { v.z() } -> std::convertible_to<double>;
};

/// A vector in world space (scene units, or unit length for directions).
template <std::floating_point T = double>
struct Vec3 {
    T x = 0, y = 0, z = 0;

    constexpr Vec3() noexcept = default;
    constexpr Vec3(T x_, T y_, T z_) noexcept : x(x_), y(y_), z(z_) {}

    /// Converts from the vector type of the caller.
    template <Vec3Like V>
    constexpr Vec3(const V& v) noexcept  // NOLINT(google-explicit-constructor)
        : x(static_cast<T>(v.x)), y(static_cast<T>(v.y)), z(static_cast<T>(v.z)) {}

    template <Vec3LikeByFunctions V>
    constexpr Vec3(const V& v) noexcept  // NOLINT(google-explicit-constructor)
        : x(static_cast<T>(v.x())), y(static_cast<T>(v.y())), z(static_cast<T>(v.z())) {}

    friend constexpr Vec3 operator+(const Vec3& a, const Vec3& b) noexcept {
        return {a.x + b.x, a.y + b.y, a.z + b.z};
    }
    friend constexpr Vec3 operator-(const Vec3& a, const Vec3& b) noexcept {
        return {a.x - b.x, a.y - b.y, a.z - b.z};
    }
    friend constexpr Vec3 operator-(const Vec3& a) noexcept { return {-a.x, -a.y, -a.z}; }
    friend constexpr Vec3 operator*(T s, const Vec3& a) noexcept {
        return {s * a.x, s * a.y, s * a.z};
    }
    friend constexpr Vec3 operator*(const Vec3& a, T s) noexcept { return s * a; }
    friend constexpr Vec3 operator/(const Vec3& a, T s) noexcept {
        return {a.x / s, a.y / s, a.z / s};
    }
    constexpr Vec3& operator+=(const Vec3& b) noexcept { return *this = *this + b; }
    constexpr Vec3& operator-=(const Vec3& b) noexcept { return *this = *this - b; }
    constexpr Vec3& operator*=(T s) noexcept { return *this = s * *this; }
    constexpr Vec3& operator/=(T s) noexcept { return *this = *this / s; }
    friend constexpr bool operator==(const Vec3&, const Vec3&) noexcept = default;
};

/// The scalar product.
template <std::floating_point T>
[[nodiscard]] constexpr T dot(const Vec3<T>& a, const Vec3<T>& b) noexcept {
    return multiply_add(a.x, b.x, multiply_add(a.y, b.y, a.z * b.z));
}

/// The sum a + s b.
template <std::floating_point T>
[[nodiscard]] constexpr Vec3<T> add_scaled(const Vec3<T>& a, NonDeduced<T> s,
                                           const Vec3<NonDeduced<T>>& b) noexcept {
    return {multiply_add(b.x, s, a.x), multiply_add(b.y, s, a.y), multiply_add(b.z, s, a.z)};
}

/// The vector product, right-handed.
template <std::floating_point T>
[[nodiscard]] constexpr Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) noexcept {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// The Euclidean length.
template <std::floating_point T>
[[nodiscard]] T length(const Vec3<T>& a) noexcept {
    return std::sqrt(dot(a, a));
}

/// The unit vector along `a`; NaN where `a` is zero (`normalized_or` has an answer there, too).
template <std::floating_point T>
[[nodiscard]] Vec3<T> normalize(const Vec3<T>& a) noexcept {
    return a / length(a);
}

/// The unit vector along `a`, or `fallback` where `a` is too short to have a direction.
template <std::floating_point T>
[[nodiscard]] Vec3<T> normalized_or(const Vec3<T>& a,
                                    const Vec3<NonDeduced<T>>& fallback) noexcept {
    const T size = length(a);
    return size > 16 * std::numeric_limits<T>::epsilon() ? (1 / size) * a : fallback;
}

/// Applies to `v` the smallest rotation that takes the unit vector `from` to the unit vector `to`.
///
/// Opposite vectors have no smallest rotation; a half turn about some perpendicular axis is used.
template <std::floating_point T>
[[nodiscard]] Vec3<T> rotate_between(const Vec3<NonDeduced<T>>& from, const Vec3<NonDeduced<T>>& to,
                                     const Vec3<T>& v) noexcept {
    const T c = dot(from, to);
    if (c < -1 + 16 * std::numeric_limits<T>::epsilon()) {
        const Vec3<T> other = std::abs(from.x) < T(0.6) ? Vec3<T>{1, 0, 0} : Vec3<T>{0, 1, 0};
        const Vec3<T> axis = normalized_or(cross(from, other), Vec3<T>{0, 0, 1});
        return 2 * dot(axis, v) * axis - v;
    }
    // The form is Rodrigues' with sin^2/(1 - cos) = 1 + cos, so that nothing is divided by the
    // sine.
    const Vec3<T> k = cross(from, to);
    return c * v + cross(k, v) + (dot(k, v) / (1 + c)) * k;
}

}  // namespace covariance
