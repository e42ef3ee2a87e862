/// Affine maps and points in double, for computations that have to be more exact than the scene's
/// single precision: hit points far from the origin, analytic intersection, inverse maps.
#pragma once

#include <cmath>

#include "core/transform.h"
#include "core/vec.h"

namespace covtrace {

struct Vec3d {
    double x = 0, y = 0, z = 0;
    constexpr Vec3d() = default;
    constexpr Vec3d(double a, double b, double c) : x(a), y(b), z(c) {}
    constexpr explicit Vec3d(Vec3 v) : x(v.x), y(v.y), z(v.z) {}
    constexpr Vec3 to_float() const {
        return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
    }
};
constexpr Vec3d operator+(Vec3d a, Vec3d b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
constexpr Vec3d operator-(Vec3d a, Vec3d b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
constexpr Vec3d operator*(Vec3d a, double s) {
    return {a.x * s, a.y * s, a.z * s};
}
constexpr double dot(Vec3d a, Vec3d b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
constexpr Vec3d cross(Vec3d a, Vec3d b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Vec3d abs(Vec3d a) {
    return {std::abs(a.x), std::abs(a.y), std::abs(a.z)};
}
inline double length(Vec3d a) {
    return std::sqrt(dot(a, a));
}
/// Unit vector along `a`; the zero vector stays zero.
inline Vec3d normalize(Vec3d a) {
    const double l = length(a);
    return l > 0 ? a * (1 / l) : a;
}

/// An affine map p -> L p + t, the linear part held as its rows.
struct Affine {
    Vec3d row[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    Vec3d translation;

    static Affine from_matrix(const Matrix4& a) {
        Affine r;
        for (size_t i = 0; i < 3; ++i) r.row[i] = {a.m[i][0], a.m[i][1], a.m[i][2]};
        r.translation = {a.m[0][3], a.m[1][3], a.m[2][3]};
        return r;
    }
    Matrix4 matrix() const {
        Matrix4 a;
        for (size_t i = 0; i < 3; ++i) a.m[i] = {row[i].x, row[i].y, row[i].z, 0};
        a.m[0][3] = translation.x, a.m[1][3] = translation.y, a.m[2][3] = translation.z;
        return a;
    }
    Vec3d vector(Vec3d v) const { return {dot(row[0], v), dot(row[1], v), dot(row[2], v)}; }
    Vec3d point(Vec3d p) const { return vector(p) + translation; }
    /// The vector v under the transpose of the linear part: covectors pulled back, or normals under
    /// the inverse map.
    Vec3d transposed(Vec3d v) const { return row[0] * v.x + row[1] * v.y + row[2] * v.z; }
    double determinant() const { return dot(row[0], cross(row[1], row[2])); }
    /// The normal n under the map, by the inverse transpose up to a positive factor: no inverse is
    /// needed.
    Vec3d normal(Vec3d n) const {
        const Vec3d c0 = cross(row[1], row[2]), c1 = cross(row[2], row[0]),
                    c2 = cross(row[0], row[1]);
        const double sign = dot(row[0], c0) < 0 ? -1 : 1;
        return Vec3d{dot(c0, n), dot(c1, n), dot(c2, n)} * sign;
    }
    /// The inverse map; the linear part must be regular.
    Affine inverse() const {
        const Vec3d c0 = cross(row[1], row[2]), c1 = cross(row[2], row[0]),
                    c2 = cross(row[0], row[1]);
        const double s = 1 / dot(row[0], c0);
        Affine r;
        r.row[0] = Vec3d{c0.x, c1.x, c2.x} * s;
        r.row[1] = Vec3d{c0.y, c1.y, c2.y} * s;
        r.row[2] = Vec3d{c0.z, c1.z, c2.z} * s;
        r.translation = r.vector(translation) * -1.0;
        return r;
    }
    /// The same map as a Transform, with its inverse; the linear part must be regular.
    Transform to_transform() const { return {matrix(), inverse().matrix()}; }
    /// Bound on the components of L v: |L| |v| with absolute values throughout.
    Vec3d absolute(Vec3d v) const {
        return {dot(abs(row[0]), v), dot(abs(row[1]), v), dot(abs(row[2]), v)};
    }
};

/// The product of two maps: a after b.
inline Affine operator*(const Affine& a, const Affine& b) {
    Affine r;
    for (int i = 0; i < 3; ++i) r.row[i] = b.transposed(a.row[i]);
    r.translation = a.point(b.translation);
    return r;
}

}  // namespace covtrace
