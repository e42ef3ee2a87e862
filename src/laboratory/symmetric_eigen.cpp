#include "laboratory/symmetric_eigen.h"

#include <cmath>

namespace covtrace {

SymmetricEigen symmetric_eigen(const covariance::SymmetricMatrix5<double>& s) {
    std::array<std::array<double, 5>, 5> a{};
    SymmetricEigen e;
    for (size_t i = 0; i < 5; ++i) {
        for (size_t j = 0; j < 5; ++j) a[i][j] = s(i, j);
        e.vectors[i][i] = 1;
    }
    constexpr int kMostSweeps = 30;  // convergence is quadratic; six are common
    for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
        double off = 0, on = 0;
        for (size_t i = 0; i < 5; ++i) {
            on += a[i][i] * a[i][i];
            for (size_t j = i + 1; j < 5; ++j) off += a[i][j] * a[i][j];
        }
        if (!(off > 1e-30 * on)) break;
        for (size_t p = 0; p < 5; ++p)
            for (size_t q = p + 1; q < 5; ++q) {
                if (a[p][q] == 0) continue;
                const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
                const double t =
                    std::copysign(1.0, theta) / (std::abs(theta) + std::hypot(theta, 1.0));
                const double c = 1 / std::hypot(t, 1.0), d = t * c;
                for (size_t k = 0; k < 5; ++k) {
                    const double kp = a[k][p], kq = a[k][q];
                    a[k][p] = c * kp - d * kq;
                    a[k][q] = d * kp + c * kq;
                }
                for (size_t k = 0; k < 5; ++k) {
                    const double pk = a[p][k], qk = a[q][k];
                    a[p][k] = c * pk - d * qk;
                    a[q][k] = d * pk + c * qk;
                    const double vp = e.vectors[p][k], vq = e.vectors[q][k];
                    e.vectors[p][k] = c * vp - d * vq;
                    e.vectors[q][k] = d * vp + c * vq;
                }
            }
    }
    for (size_t i = 0; i < 5; ++i) e.values[i] = a[i][i];
    return e;
}

}  // namespace covtrace
