/// Four doubles that are computed with together.
#pragma once

#ifdef __FMA__
#include <immintrin.h>
#endif

#include "covariance/covariance.hpp"

// How such vectors are passed depends on the processor that is compiled for, which is one for all
// of the program.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace covtrace {

using Double4 __attribute__((vector_size(32))) = double;
inline Double4 all4(double a) {
    return Double4{a, a, a, a};
}
/// a b + c; whether the product is rounded depends on the processor that is compiled for.
inline Double4 add_product4(const Double4& a, const Double4& b, const Double4& c) {
#ifdef __FMA__
    return _mm256_fmadd_pd(a, b, c);
#else
    return a * b + c;
#endif
}
inline Double4 add_product4(const Double4& a, double b, const Double4& c) {
    return add_product4(a, all4(b), c);
}

/// The axes x, y, z of a frame side by side: the first three of each component.
struct Axes4 {
    Double4 x, y, z;

    explicit Axes4(const covariance::Frame<double>& f)
        : x{f.x.x, f.y.x, f.z.x, 0}, y{f.x.y, f.y.y, f.z.y, 0}, z{f.x.z, f.y.z, f.z.z, 0} {}
    /// Of each axis with v.
    Double4 dot(const covariance::Vec3<double>& v) const {
        return add_product4(x, v.x, add_product4(y, v.y, z * all4(v.z)));
    }
    /// Each axis plus its part of `s` times v.
    void add(const Double4& s, const covariance::Vec3<double>& v) {
        x = add_product4(s, v.x, x);
        y = add_product4(s, v.y, y);
        z = add_product4(s, v.z, z);
    }
    covariance::Frame<double> frame() const {
        return {{x[0], y[0], z[0]}, {x[1], y[1], z[1]}, {x[2], y[2], z[2]}};
    }
};

/// (a0 a0, a0 a1, a1 a1): the square a a^T of the first two.
inline Double4 square4(const Double4& a) {
    return __builtin_shufflevector(a, a, 0, 0, 1, 1) * __builtin_shufflevector(a, a, 0, 1, 1, 1);
}

}  // namespace covtrace
