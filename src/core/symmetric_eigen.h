/// Eigen-decomposition of small symmetric matrices by Jacobi's method (Golub and Van Loan, "Matrix
/// Computations", section 8.5), exact up to rounding.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace covtrace {

template <size_t N>
using SquareMatrix = std::array<std::array<double, N>, N>;

template <size_t N>
struct SymmetricEigen {
    std::array<double, N> values{};
    SquareMatrix<N> vectors{};  ///< unit; vectors[k] belongs to values[k]
};

/// Eigenvalues and eigenvectors of the symmetric matrix `a`, whose numbers must be finite.
template <size_t N>
SymmetricEigen<N> symmetric_eigen(SquareMatrix<N> a) {
    SymmetricEigen<N> e;
    for (size_t i = 0; i < N; ++i) e.vectors[i][i] = 1;
    constexpr int kMostSweeps = 30;  // convergence is quadratic; six are common
    for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
        double off = 0, on = 0;
        for (size_t i = 0; i < N; ++i) {
            on += a[i][i] * a[i][i];
            for (size_t j = i + 1; j < N; ++j) off += a[i][j] * a[i][j];
        }
        if (!(off > 1e-30 * on)) break;
        for (size_t p = 0; p < N; ++p)
            for (size_t q = p + 1; q < N; ++q) {
                if (a[p][q] == 0) continue;
                const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
                const double t =
                    std::copysign(1.0, theta) / (std::abs(theta) + std::hypot(theta, 1.0));
                const double c = 1 / std::hypot(t, 1.0), d = t * c;
                for (size_t k = 0; k < N; ++k) {
                    const double kp = a[k][p], kq = a[k][q];
                    a[k][p] = c * kp - d * kq;
                    a[k][q] = d * kp + c * kq;
                }
                for (size_t k = 0; k < N; ++k) {
                    const double pk = a[p][k], qk = a[q][k];
                    a[p][k] = c * pk - d * qk;
                    a[q][k] = d * pk + c * qk;
                    const double vp = e.vectors[p][k], vq = e.vectors[q][k];
                    e.vectors[p][k] = c * vp - d * vq;
                    e.vectors[q][k] = d * vp + c * vq;
                }
            }
    }
    for (size_t i = 0; i < N; ++i) e.values[i] = a[i][i];
    return e;
}

}  // namespace covtrace
