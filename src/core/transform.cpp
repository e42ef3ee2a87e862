#include "core/transform.h"

#include <cmath>

namespace covtrace {

namespace {

constexpr double kRadians = 3.14159265358979323846 / 180.0;

}  // namespace

Matrix4 operator*(const Matrix4& a, const Matrix4& b) {
    Matrix4 c;
    for (size_t i = 0; i < 4; ++i)
        for (size_t j = 0; j < 4; ++j) {
            double s = 0;
            for (size_t k = 0; k < 4; ++k) s += a.m[i][k] * b.m[k][j];
            c.m[i][j] = s;
        }
    return c;
}

Matrix4 transpose(const Matrix4& a) {
    Matrix4 t;
    for (size_t i = 0; i < 4; ++i)
        for (size_t j = 0; j < 4; ++j) t.m[i][j] = a.m[j][i];
    return t;
}

std::optional<Matrix4> inverse(const Matrix4& a) {
    Matrix4 left = a, right;
    for (size_t c = 0; c < 4; ++c) {
        size_t pivot = c;
        for (size_t r = c + 1; r < 4; ++r)
            if (std::abs(left.m[r][c]) > std::abs(left.m[pivot][c])) pivot = r;
        const double p = left.m[pivot][c];
        if (!(std::abs(p) > 1e-300) || !std::isfinite(p)) return std::nullopt;
        std::swap(left.m[c], left.m[pivot]);
        std::swap(right.m[c], right.m[pivot]);
        for (size_t j = 0; j < 4; ++j) {
            left.m[c][j] /= p;
            right.m[c][j] /= p;
        }
        for (size_t r = 0; r < 4; ++r) {
            const double f = left.m[r][c];
            if (r == c || f == 0) continue;
            for (size_t j = 0; j < 4; ++j) {
                left.m[r][j] -= f * left.m[c][j];
                right.m[r][j] -= f * right.m[c][j];
            }
        }
    }
    for (const auto& row : right.m)
        for (double v : row)
            if (!std::isfinite(v)) return std::nullopt;
    return right;
}

std::optional<Transform> Transform::from_matrix(const Matrix4& matrix) {
    const auto inv = covtrace::inverse(matrix);
    if (!inv) return std::nullopt;
    return Transform(matrix, *inv);
}

Transform Transform::translate(Vec3 d) {
    Matrix4 a, b;
    for (int i = 0; i < 3; ++i) {
        a.m[size_t(i)][3] = d[i];
        b.m[size_t(i)][3] = -d[i];
    }
    return {a, b};
}

Transform Transform::scale(double x, double y, double z) {
    Matrix4 a, b;
    a.m[0][0] = x, a.m[1][1] = y, a.m[2][2] = z;
    b.m[0][0] = 1 / x, b.m[1][1] = 1 / y, b.m[2][2] = 1 / z;
    return {a, b};
}

Transform Transform::rotate(double degrees, Vec3 axis) {
    const double l =
        std::sqrt(double(axis.x) * axis.x + double(axis.y) * axis.y + double(axis.z) * axis.z);
    if (!(l > 0)) return {};
    const double x = axis.x / l, y = axis.y / l, z = axis.z / l;
    const double s = std::sin(degrees * kRadians), c = std::cos(degrees * kRadians), k = 1 - c;
    Matrix4 a;
    a.m[0] = {x * x * k + c, x * y * k - z * s, x * z * k + y * s, 0};
    a.m[1] = {x * y * k + z * s, y * y * k + c, y * z * k - x * s, 0};
    a.m[2] = {x * z * k - y * s, y * z * k + x * s, z * z * k + c, 0};
    return {a, transpose(a)};
}

std::optional<Transform> Transform::look_at(Vec3 eye, Vec3 look, Vec3 up) {
    const Vec3 dir = normalize(look - eye);
    const Vec3 side = cross(normalize(up), dir);
    if (!(length(dir) > 0) || !(length(side) > 1e-7f)) return std::nullopt;
    const Vec3 right = normalize(side);
    const Vec3 new_up = cross(dir, right);
    Matrix4 camera_to_world;
    for (int i = 0; i < 3; ++i) {
        camera_to_world.m[size_t(i)] = {right[i], new_up[i], dir[i], eye[i]};
    }
    const auto inv = covtrace::inverse(camera_to_world);
    if (!inv) return std::nullopt;
    return Transform(*inv, camera_to_world);
}

namespace {
Vec3 apply(const Matrix4& a, Vec3 p, double w) {
    double r[3];
    for (size_t i = 0; i < 3; ++i)
        r[i] = a.m[i][0] * p.x + a.m[i][1] * p.y + a.m[i][2] * p.z + a.m[i][3] * w;
    return {static_cast<float>(r[0]), static_cast<float>(r[1]), static_cast<float>(r[2])};
}
}  // namespace

Vec3 Transform::point(Vec3 p) const {
    const auto& last = matrix_.m[3];
    const double w = last[0] * p.x + last[1] * p.y + last[2] * p.z + last[3];
    const Vec3 r = apply(matrix_, p, 1);
    return w == 1 ? r : r * static_cast<float>(1 / w);
}

Vec3 Transform::vector(Vec3 v) const {
    return apply(matrix_, v, 0);
}

Vec3 Transform::normal(Vec3 n) const {
    const auto& a = inverse_.m;
    double r[3];
    for (size_t i = 0; i < 3; ++i) r[i] = a[0][i] * n.x + a[1][i] * n.y + a[2][i] * n.z;
    return {static_cast<float>(r[0]), static_cast<float>(r[1]), static_cast<float>(r[2])};
}

bool Transform::swaps_handedness() const {
    const auto& a = matrix_.m;
    const double det = a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) -
                       a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
                       a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
    return det < 0;
}

Transform operator*(const Transform& a, const Transform& b) {
    return {a.matrix() * b.matrix(), b.inverse_matrix() * a.inverse_matrix()};
}

}  // namespace covtrace
