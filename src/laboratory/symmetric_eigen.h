/// Eigen-decomposition of symmetric 5x5 matrices, for the measurements; no path of the analysis
/// needs one.
#pragma once

#include <array>

#include "covariance/covariance.hpp"

namespace covtrace {

struct SymmetricEigen {
    std::array<double, 5> values{};
    std::array<std::array<double, 5>, 5> vectors{};  ///< unit; vectors[k] belongs to values[k]
};

/// Jacobi's method, to rounding.
SymmetricEigen symmetric_eigen(const covariance::SymmetricMatrix5<double>& s);

/// The symmetric matrix with the same eigenvectors and the eigenvalues f(lambda).
template <typename F>
covariance::SymmetricMatrix5<double> map_eigenvalues(const covariance::SymmetricMatrix5<double>& s,
                                                     F f) {
    const SymmetricEigen e = symmetric_eigen(s);
    covariance::SymmetricMatrix5<double> r;
    for (size_t k = 0; k < 5; ++k) {
        const double value = f(e.values[k]);
        for (size_t i = 0; i < 5; ++i)
            for (size_t j = i; j < 5; ++j) r(i, j) += value * e.vectors[k][i] * e.vectors[k][j];
    }
    return r;
}

}  // namespace covtrace
