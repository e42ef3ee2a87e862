// Matrix5 and the master rule, the one line that every change of coordinates here obeys:
//
//   L_new(p) = L_old(A p)   =>   Sigma_new = A^T Sigma_old A        (A: old from new coordinates)
//
// The operators of the other headers are cheap special cases; each of them also offers its A.
#pragma once

#include <array>
#include <cstddef>

#include "covariance/symmetric.hpp"

namespace covariance {

/// A general 5x5 matrix over (x, y, u, v, t), usually "old coordinates from new ones".
template <std::floating_point T = double>
struct Matrix5 {
    using Scalar = T;
    std::array<std::array<T, 5>, 5> rows{};

    [[nodiscard]] constexpr T& operator()(std::size_t i, std::size_t j) noexcept {
        return rows[i][j];
    }
    [[nodiscard]] constexpr const T& operator()(std::size_t i, std::size_t j) const noexcept {
        return rows[i][j];
    }

    [[nodiscard]] static constexpr Matrix5 identity() noexcept {
        Matrix5 a;
        for (std::size_t i = 0; i < 5; ++i) a(i, i) = 1;
        return a;
    }

    /// Writes a 2x2 block whose first entry is (row, column).
    constexpr Matrix5& set_block(std::size_t row, std::size_t column, const Mat2<T>& m) noexcept {
        rows[row][column] = m.m00, rows[row][column + 1] = m.m01;
        rows[row + 1][column] = m.m10, rows[row + 1][column + 1] = m.m11;
        return *this;
    }

    /// The product A1 * A2 is the change of coordinates of event 1 (nearer the light) followed by
    /// event 2.
    friend constexpr Matrix5 operator*(const Matrix5& a, const Matrix5& b) noexcept {
        Matrix5 c;
        for (std::size_t i = 0; i < 5; ++i)
            for (std::size_t j = 0; j < 5; ++j)
                for (std::size_t k = 0; k < 5; ++k) c(i, j) += a(i, k) * b(k, j);
        return c;
    }
    friend constexpr bool operator==(const Matrix5&, const Matrix5&) noexcept = default;
};

/// The master rule: A^T S A.
///
/// Shapes   s: symmetric 5x5; a: 5x5, old coordinates from new.
/// Post     positive semi-definite where s is; det multiplied by det(A)^2.
/// Errors   none; NaN in gives NaN out.
/// Cost     200 multiplications; the specialised operators cost about 20 to 60.
template <std::floating_point T>
[[nodiscard]] constexpr SymmetricMatrix5<T> transform(const SymmetricMatrix5<T>& s,
                                                      const Matrix5<T>& a) noexcept {
    Matrix5<T> sa;
    for (std::size_t i = 0; i < 5; ++i)
        for (std::size_t k = 0; k < 5; ++k)
            for (std::size_t j = 0; j < 5; ++j) sa(i, j) += s(i, k) * a(k, j);
    SymmetricMatrix5<T> result;
    for (std::size_t i = 0; i < 5; ++i)
        for (std::size_t k = 0; k < 5; ++k)
            for (std::size_t j = i; j < 5; ++j) result(i, j) += a(k, i) * sa(k, j);
    return result;
}

}  // namespace covariance
