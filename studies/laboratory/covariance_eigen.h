/// Eigen-decomposition of covariances, for the measurements; no path of the analysis needs one.
#pragma once

#include "core/symmetric_eigen.h"
#include "covariance/covariance.hpp"

namespace covtrace {

inline SymmetricEigen<5> covariance_eigen(const covariance::SymmetricMatrix5<double>& s) {
    SquareMatrix<5> a;
    for (size_t i = 0; i < 5; ++i)
        for (size_t j = 0; j < 5; ++j) a[i][j] = s(i, j);
    return symmetric_eigen(a);
}

/// The symmetric matrix with the same eigenvectors and the eigenvalues f(lambda).
template <typename F>
covariance::SymmetricMatrix5<double> map_eigenvalues(const covariance::SymmetricMatrix5<double>& s,
                                                     F f) {
    const SymmetricEigen<5> e = covariance_eigen(s);
    covariance::SymmetricMatrix5<double> r;
    for (size_t k = 0; k < 5; ++k) {
        const double value = f(e.values[k]);
        for (size_t i = 0; i < 5; ++i)
            for (size_t j = i; j < 5; ++j) r(i, j) += value * e.vectors[k][i] * e.vectors[k][j];
    }
    return r;
}

}  // namespace covtrace
