// SymmetricMatrix5: the covariance matrix itself, 15 numbers, and its 2x2 blocks.
//
//   Sigma = Int W W^T |Lhat(W)| dW / Int |Lhat(W)| dW      over W = (x, y, u, v, t)
//
// the second moment of the amplitude spectrum of the local light field, in ordinary frequencies
// (cycles per unit): Sxx in 1/m^2, Sxu in 1/(m rad), Stt in 1/s^2; m stands for the scene unit.
// Defined by Belcour et al. 2013, "5D Covariance Tracing for Efficient Defocus and Motion Blur".
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "covariance/sym2.hpp"

namespace covariance {

/// Names of the five axes: position x, y; slope u, v; time t.
namespace axis {
inline constexpr std::size_t x = 0, y = 1, u = 2, v = 3, t = 4;
}  // namespace axis

/// A symmetric 5x5 matrix over (x, y, u, v, t), stored as its upper triangle row by row.
template <std::floating_point T = double>
struct SymmetricMatrix5 {
    using Scalar = T;
    std::array<T, 15> values{};

    /// Place of entry (i, j) in `values`; the order of i and j does not matter. Both are below 5.
    [[nodiscard]] static constexpr std::size_t index(std::size_t i, std::size_t j) noexcept {
        return i <= j ? i * (9 - i) / 2 + j : j * (9 - j) / 2 + i;
    }
    [[nodiscard]] constexpr T& operator()(std::size_t i, std::size_t j) noexcept {
        return values[index(i, j)];
    }
    [[nodiscard]] constexpr const T& operator()(std::size_t i, std::size_t j) const noexcept {
        return values[index(i, j)];
    }

    [[nodiscard]] static constexpr SymmetricMatrix5 diagonal(T x, T y, T u, T v, T t) noexcept {
        SymmetricMatrix5 s;
        s(0, 0) = x, s(1, 1) = y, s(2, 2) = u, s(3, 3) = v, s(4, 4) = t;
        return s;
    }

    /// The block of the positions, rows and columns x, y.
    [[nodiscard]] constexpr Sym2<T> spatial() const noexcept {
        return {values[0], values[1], values[5]};
    }
    /// The block of the slopes, rows and columns u, v.
    [[nodiscard]] constexpr Sym2<T> angular() const noexcept {
        return {values[9], values[10], values[12]};
    }
    /// The block between positions and slopes, rows x, y and columns u, v.
    [[nodiscard]] constexpr Mat2<T> cross() const noexcept {
        return {values[2], values[3], values[6], values[7]};
    }

    constexpr void set_spatial(const Sym2<T>& s) noexcept {
        values[0] = s.xx, values[1] = s.xy, values[5] = s.yy;
    }
    constexpr void set_angular(const Sym2<T>& s) noexcept {
        values[9] = s.xx, values[10] = s.xy, values[12] = s.yy;
    }
    constexpr void set_cross(const Mat2<T>& m) noexcept {
        values[2] = m.m00, values[3] = m.m01, values[6] = m.m10, values[7] = m.m11;
    }

    friend constexpr SymmetricMatrix5 operator+(SymmetricMatrix5 a,
                                                const SymmetricMatrix5& b) noexcept {
        for (std::size_t i = 0; i < 15; ++i) a.values[i] += b.values[i];
        return a;
    }
    friend constexpr SymmetricMatrix5 operator-(SymmetricMatrix5 a,
                                                const SymmetricMatrix5& b) noexcept {
        for (std::size_t i = 0; i < 15; ++i) a.values[i] -= b.values[i];
        return a;
    }
    friend constexpr SymmetricMatrix5 operator*(T s, SymmetricMatrix5 a) noexcept {
        for (T& value : a.values) value *= s;
        return a;
    }
    friend constexpr bool operator==(const SymmetricMatrix5&,
                                     const SymmetricMatrix5&) noexcept = default;
};

/// Adds w s to `sum`.
template <std::floating_point T>
constexpr void add_scaled(SymmetricMatrix5<T>& sum, NonDeduced<T> w,
                          const SymmetricMatrix5<NonDeduced<T>>& s) noexcept {
    for (std::size_t i = 0; i < 15; ++i)
        sum.values[i] = multiply_add(s.values[i], w, sum.values[i]);
}

/// The sum of the diagonal, whose entries differ in unit: a size for tolerances.
template <std::floating_point T>
[[nodiscard]] constexpr T trace(const SymmetricMatrix5<T>& s) noexcept {
    return s(0, 0) + s(1, 1) + s(2, 2) + s(3, 3) + s(4, 4);
}

/// Whether every entry is a finite number. A path whose matrix is not finite has to be left out.
template <std::floating_point T>
[[nodiscard]] bool is_finite(const SymmetricMatrix5<T>& s) noexcept {
    // A product with 0 is not a number where a value is not finite.
    bool finite = true;
    for (const T v : s.values) finite &= v * 0 == 0;
    return finite;
}

/// The matrix in another precision, for example to keep floats in a pixel buffer.
template <std::floating_point To, std::floating_point From>
[[nodiscard]] constexpr SymmetricMatrix5<To> cast(const SymmetricMatrix5<From>& s) noexcept {
    SymmetricMatrix5<To> result;
    for (std::size_t i = 0; i < 15; ++i) result.values[i] = static_cast<To>(s.values[i]);
    return result;
}

}  // namespace covariance
