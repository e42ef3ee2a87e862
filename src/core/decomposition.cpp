#include "core/decomposition.h"

#include <algorithm>
#include <cmath>

namespace covtrace {

namespace {

using Matrix3 = std::array<std::array<double, 3>, 3>;

Matrix3 linear_part(const Matrix4& a) {
    Matrix3 m{};
    for (size_t i = 0; i < 3; ++i)
        for (size_t j = 0; j < 3; ++j) m[i][j] = a.m[i][j];
    return m;
}

Vec3 translation_of(const Matrix4& a) {
    return {static_cast<float>(a.m[0][3]), static_cast<float>(a.m[1][3]),
            static_cast<float>(a.m[2][3])};
}

/// The unit quaternion of a rotation matrix.
Quaternion from_matrix(const Matrix3& m) {
    const double trace = m[0][0] + m[1][1] + m[2][2];
    Quaternion q;
    if (trace > 0) {
        const double s = std::sqrt(trace + 1.0) * 2;
        q = {(m[2][1] - m[1][2]) / s, (m[0][2] - m[2][0]) / s, (m[1][0] - m[0][1]) / s, 0.25 * s};
    } else {
        const size_t i =
            m[0][0] > m[1][1] ? (m[0][0] > m[2][2] ? 0 : 2) : (m[1][1] > m[2][2] ? 1 : 2);
        const size_t j = (i + 1) % 3, k = (i + 2) % 3;
        const double s = std::sqrt(std::max(0.0, m[i][i] - m[j][j] - m[k][k] + 1.0)) * 2;
        double v[3];
        v[i] = 0.25 * s;
        v[j] = (m[j][i] + m[i][j]) / s;
        v[k] = (m[k][i] + m[i][k]) / s;
        q = {v[0], v[1], v[2], (m[k][j] - m[j][k]) / s};
    }
    const double n = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    return {q.x / n, q.y / n, q.z / n, q.w / n};
}

/// Matrix of the cofactors: the inverse transpose times the determinant.
Matrix3 cofactors(const Matrix3& m) {
    Matrix3 c{};
    for (size_t i = 0; i < 3; ++i)
        for (size_t j = 0; j < 3; ++j) {
            const size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            c[i][j] = m[i1][j1] * m[i2][j2] - m[i1][j2] * m[i2][j1];
        }
    return c;
}

double norm(const Matrix3& m) {
    double sum = 0;
    for (const auto& row : m)
        for (const double v : row) sum += v * v;
    return std::sqrt(sum);
}

/// Replaces `m` by the orthogonal matrix nearest to it, a reflection where `m` mirrors; false where
/// `m` is singular.
bool make_orthogonal(Matrix3& m) {
    constexpr int kMostSteps = 100;      // as pbrt; a condition of 1e12 takes about ten
    constexpr double kConverged = 1e-9;  // the next step would change its square
    for (int step = 0; step < kMostSteps; ++step) {
        const Matrix3 c = cofactors(m);
        const double determinant = m[0][0] * c[0][0] + m[0][1] * c[0][1] + m[0][2] * c[0][2];
        const double size = norm(m), inverse_size = norm(c) / std::abs(determinant);
        if (!(size > 0) || !(inverse_size > 0) || !std::isfinite(inverse_size)) return false;
        // Scaling (Higham 1986) brings distant singular values together in few steps.
        const double scale = std::sqrt(inverse_size / size);
        double change = 0;
        for (size_t i = 0; i < 3; ++i)
            for (size_t j = 0; j < 3; ++j) {
                const double next = 0.5 * (scale * m[i][j] + c[i][j] / (determinant * scale));
                change = std::max(change, std::abs(next - m[i][j]));
                m[i][j] = next;
            }
        if (change < kConverged) break;
    }
    return true;
}

}  // namespace

Decomposition polar_decomposition(const Matrix4& map) {
    Decomposition d;
    d.translation = translation_of(map);
    const Matrix3 linear = linear_part(map);
    Matrix3 r = linear;
    if (!make_orthogonal(r)) {
        d.stretch = linear;
        return d;
    }
    const Matrix3 c = cofactors(r);
    const bool mirrors = r[0][0] * c[0][0] + r[0][1] * c[0][1] + r[0][2] * c[0][2] < 0;
    // A reflection is turned into a rotation by the opposite sign, in three dimensions.
    if (mirrors)
        for (auto& row : r)
            for (double& v : row) v = -v;
    d.rotation = from_matrix(r);
    for (size_t i = 0; i < 3; ++i)
        for (size_t j = 0; j < 3; ++j) {
            double s = 0;  // rotation^T * linear, and its mirror image across the diagonal
            for (size_t k = 0; k < 3; ++k) s += r[k][i] * linear[k][j] + r[k][j] * linear[k][i];
            d.stretch[i][j] = 0.5 * s;
        }
    return d;
}

Decomposition triangular_decomposition(const Matrix4& map) {
    Decomposition d;
    d.translation = translation_of(map);
    double q[3][3];  // q[i]: i-th orthonormal column
    Matrix3 r{};
    for (size_t c = 0; c < 3; ++c) {
        double v[3] = {map.m[0][c], map.m[1][c], map.m[2][c]};
        for (size_t p = 0; p < c; ++p) {
            r[p][c] = q[p][0] * v[0] + q[p][1] * v[1] + q[p][2] * v[2];
            for (int i = 0; i < 3; ++i) v[i] -= r[p][c] * q[p][i];
        }
        r[c][c] = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        for (int i = 0; i < 3; ++i)
            q[c][i] = r[c][c] > 0 ? v[i] / r[c][c] : (i == int(c) ? 1.0 : 0.0);
    }
    const double det = q[0][0] * (q[1][1] * q[2][2] - q[1][2] * q[2][1]) -
                       q[0][1] * (q[1][0] * q[2][2] - q[1][2] * q[2][0]) +
                       q[0][2] * (q[1][0] * q[2][1] - q[1][1] * q[2][0]);
    if (det < 0) {
        for (int i = 0; i < 3; ++i) q[2][i] = -q[2][i];
        r[2][2] = -r[2][2];
    }
    d.rotation = from_matrix(
        {{{q[0][0], q[1][0], q[2][0]}, {q[0][1], q[1][1], q[2][1]}, {q[0][2], q[1][2], q[2][2]}}});
    d.stretch = r;
    return d;
}

}  // namespace covtrace
