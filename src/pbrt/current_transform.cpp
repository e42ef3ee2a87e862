#include "pbrt/current_transform.h"

#include <cmath>

namespace covtrace {

namespace {

/// Determinant over the product of the columns' lengths: 1 for orthogonal axes, 0 where the matrix
/// flattens space.
double relative_determinant(const Matrix4& a) {
    const auto& m = a.m;
    const double det = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                       m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                       m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    double lengths = 1;
    for (size_t c = 0; c < 3; ++c) lengths *= std::hypot(m[0][c], m[1][c], m[2][c]);
    return lengths > 0 ? std::abs(det) / lengths : 0;
}

bool fits_float(const Matrix4& a) {
    constexpr double largest = 1e30;
    for (const auto& row : a.m)
        for (const double v : row)
            if (!(std::abs(v) <= largest)) return false;
    return true;
}

}  // namespace

const Transform& CurrentTransform::get(const SourceLocation& user) const {
    if (!problem_) return transform_;
    const std::string place = user.to_string();
    throw Error(ErrorKind::scene, problem_->where,
                problem_->text + (place.empty() ? "" : "; it is used at " + place));
}

CurrentTransform CurrentTransform::times(const CurrentTransform& inner,
                                         const SourceLocation& where) const {
    if (problem_) return *this;
    if (inner.problem_) return inner;
    const Transform product = transform_ * inner.transform_;
    if (!fits_float(product.matrix()) || !fits_float(product.inverse_matrix()))
        return {where, "the numbers of the current transformation get too large"};
    return product;
}

CurrentTransform transform_of_matrix(const std::array<double, 16>& columns,
                                     const SourceLocation& where) {
    Matrix4 m;
    for (size_t i = 0; i < 16; ++i) m.m[i % 4][i / 4] = columns[i];
    auto& last = m.m[3];
    constexpr double tolerance = 1e-6;
    for (size_t i = 0; i < 3; ++i)
        if (std::abs(last[i]) > tolerance)
            return {where, "the matrix is projective; expected 0 0 0 1 in its last row"};
    const CurrentTransform singular(where,
                                    "the matrix is singular; expected one that can be inverted");
    if (!(std::abs(last[3]) > tolerance)) return singular;
    for (auto& row : m.m)
        for (double& v : row) v /= columns[15];
    last = {0, 0, 0, 1};
    constexpr double flat = 1e-10;
    const auto t = Transform::from_matrix(m);
    if (!t || !(relative_determinant(m) > flat) || !fits_float(m) ||
        !fits_float(t->inverse_matrix()))
        return singular;
    return *t;
}

CurrentTransform transform_of_scale(double x, double y, double z, const SourceLocation& where) {
    if (x == 0 || y == 0 || z == 0) return {where, "Scale by zero is a singular transformation"};
    return Transform::scale(x, y, z);
}

Transform transform_of_rotation(double degrees, Vec3 axis, const SourceLocation& where) {
    if (!(length_squared(axis) > 0) || !is_finite(length_squared(axis) * Vec3{1, 1, 1}))
        throw Error(ErrorKind::scene, where, "the axis of Rotate has no length");
    return Transform::rotate(degrees, axis);
}

Transform transform_of_look_at(Vec3 eye, Vec3 look, Vec3 up, const SourceLocation& where) {
    const auto t = Transform::look_at(eye, look, up);
    if (!t)
        throw Error(ErrorKind::scene, where,
                    "LookAt is degenerate: expected an eye apart from the point looked at, and an "
                    "up vector "
                    "that is not along the view");
    return *t;
}

}  // namespace covtrace
