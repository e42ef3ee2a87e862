/// Frames as vectors of four numbers, for operators that treat all three axes alike.
#pragma once

#include "core/simd.h"
#include "covariance/covariance.hpp"

namespace covtrace {

/// Axes of a frame side by side: x holds the x components of the frame's three axes in its first
/// three lanes, y and z hold the other components. The fourth lane begins as 0.
struct Axes4 {
    Double4 x, y, z;

    explicit Axes4(const covariance::Frame<double>& f)
        : x{f.x.x, f.y.x, f.z.x, 0}, y{f.x.y, f.y.y, f.z.y, 0}, z{f.x.z, f.y.z, f.z.z, 0} {}
    /// Dot products of the axes with v.
    Double4 dot(const covariance::Vec3<double>& v) const {
        return multiply_add(x, v.x, multiply_add(y, v.y, z * all4(v.z)));
    }
    /// Adds to each axis its lane of `s` times v.
    void add(const Double4& s, const covariance::Vec3<double>& v) {
        x = multiply_add(s, v.x, x);
        y = multiply_add(s, v.y, y);
        z = multiply_add(s, v.z, z);
    }
    covariance::Frame<double> frame() const {
        return {{x[0], y[0], z[0]}, {x[1], y[1], z[1]}, {x[2], y[2], z[2]}};
    }
};

/// Products a a^T of the first two lanes: (a0 a0, a0 a1, a1 a1, a1 a1).
inline Double4 square4(const Double4& a) {
    return __builtin_shufflevector(a, a, 0, 0, 1, 1) * __builtin_shufflevector(a, a, 0, 1, 1, 1);
}

}  // namespace covtrace
