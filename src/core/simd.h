/// Vectors of eight floats and of four doubles, worked on together (vector types of GCC and Clang).
/// Sums have a fixed order, so that a build gives the same bits on any machine; whether the product
/// in multiply_add and subtract_product is rounded is settled when the program is compiled.
#pragma once

#ifdef __AVX__
#include <immintrin.h>
#endif

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

// The warning is about the calling convention for such vectors, which depends on the processor that
// is compiled for: one for all of the program.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace covtrace {

using Float8 __attribute__((vector_size(32))) = float;
/// Result of a comparison: all bits of the k-th lane are set where it holds for the k-th pair.
using Mask8 = decltype(Float8{} < Float8{});
constexpr size_t kLanes = 8;

inline Float8 all8(float a) {
    return Float8{a, a, a, a, a, a, a, a};
}
inline Float8 load8(const float* from) {
    Float8 v;
    std::memcpy(&v, from, sizeof v);
    return v;
}
inline void store8(const Float8& v, float* to) {
    std::memcpy(to, &v, sizeof v);
}
/// The larger of each pair, a > b ? a : b, for which compilers take two instructions.
inline Float8 max8(const Float8& a, const Float8& b) {
#ifdef __AVX__
    return reinterpret_cast<Float8>(
        _mm256_max_ps(reinterpret_cast<__m256>(a), reinterpret_cast<__m256>(b)));
#else
    return a > b ? a : b;
#endif
}
/// The smaller of each pair, a < b ? a : b.
inline Float8 min8(const Float8& a, const Float8& b) {
#ifdef __AVX__
    return reinterpret_cast<Float8>(
        _mm256_min_ps(reinterpret_cast<__m256>(a), reinterpret_cast<__m256>(b)));
#else
    return a < b ? a : b;
#endif
}
inline Float8 abs8(const Float8& a) {
#ifdef __AVX__
    return reinterpret_cast<Float8>(
        _mm256_andnot_ps(_mm256_set1_ps(-0.0f), reinterpret_cast<__m256>(a)));
#else
    return max8(a, -a);
#endif
}
inline Float8 sqrt8(const Float8& a) {
#ifdef __AVX__
    return reinterpret_cast<Float8>(_mm256_sqrt_ps(reinterpret_cast<__m256>(a)));
#else
    Float8 roots;
    for (int k = 0; k < 8; ++k) roots[k] = std::sqrt(a[k]);
    return roots;
#endif
}
/// The sum a b + c; whether the product is rounded depends on the processor that is compiled for.
inline Float8 multiply_add(const Float8& a, const Float8& b, const Float8& c) {
#ifdef __FMA__
    return reinterpret_cast<Float8>(_mm256_fmadd_ps(
        reinterpret_cast<__m256>(a), reinterpret_cast<__m256>(b), reinterpret_cast<__m256>(c)));
#else
    return a * b + c;
#endif
}
/// The difference c - a b, rounded as in multiply_add.
inline Float8 subtract_product(const Float8& a, const Float8& b, const Float8& c) {
#ifdef __FMA__
    return reinterpret_cast<Float8>(_mm256_fnmadd_ps(
        reinterpret_cast<__m256>(a), reinterpret_cast<__m256>(b), reinterpret_cast<__m256>(c)));
#else
    return c - a * b;
#endif
}
/// The mask as a number whose bit k tells whether the k-th lane is set.
inline unsigned bits8(const Mask8& mask) {
#ifdef __AVX__
    return static_cast<unsigned>(_mm256_movemask_ps(reinterpret_cast<__m256>(mask)));
#else
    unsigned bits = 0;
    for (unsigned k = 0; k < 8; ++k) bits |= mask[k] != 0 ? 1u << k : 0u;
    return bits;
#endif
}

/// The sum of all eight lanes, in a fixed order.
inline float sum8(const Float8& s) {
    return ((s[0] + s[4]) + (s[1] + s[5])) + ((s[2] + s[6]) + (s[3] + s[7]));
}

/// The exponential exp(x) for x <= 0, with a relative error of 5e-6; below -80 it stays exp(-80),
/// which is nothing. 2^x is the power of its nearest integer, put into the exponent's bits, times a
/// polynomial of the rest.
inline Float8 exp_of_negative(const Float8& x) {
    using Integers = uint32_t __attribute__((vector_size(sizeof(Float8))));
    constexpr float kLog2E = 1.44269504f, kRounder = 12582912.0f;  // 1.5 * 2^23
    const Float8 power = kLog2E * (x < -80.0f ? -80.0f - Float8{} : x);
    const Float8 rounded = power + kRounder, rest = power - (rounded - kRounder);
    Integers bits;
    std::memcpy(&bits, &rounded, sizeof bits);
    bits = (bits + 127) << 23;
    Float8 scale;
    std::memcpy(&scale, &bits, sizeof scale);
    // Evaluate Taylor's polynomial of 2^rest, |rest| <= 1/2
    Float8 sum = 1.5403530e-4f - Float8{};
    for (float c :
         {1.3333558e-3f, 9.6181291e-3f, 5.5504109e-2f, 2.4022651e-1f, 6.9314718e-1f, 1.0f})
        sum = multiply_add(sum, rest, c - Float8{});
    return sum * scale;
}

using Double4 __attribute__((vector_size(32))) = double;
inline Double4 all4(double a) {
    return Double4{a, a, a, a};
}
/// a b + c; whether the product is rounded depends on the processor that is compiled for.
inline Double4 multiply_add(const Double4& a, const Double4& b, const Double4& c) {
#ifdef __FMA__
    return _mm256_fmadd_pd(a, b, c);
#else
    return a * b + c;
#endif
}
inline Double4 multiply_add(const Double4& a, double b, const Double4& c) {
    return multiply_add(a, all4(b), c);
}

}  // namespace covtrace
