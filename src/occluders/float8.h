/// Eight floats that are computed with together.
#pragma once

#include <immintrin.h>

#include <cmath>

#include "core/vec.h"

// The warning is about the calling convention for such vectors, which depends on the processor that
// is compiled for: one for all of the program.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace covtrace {

using Float8 __attribute__((vector_size(32))) = float;
/// Result of a comparison: all bits of the k-th lane are set where it holds for the k-th pair.
using Mask8 = decltype(Float8{} < Float8{});
inline Float8 all8(float a) {
    return Float8{a, a, a, a, a, a, a, a};
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
inline Float8 add_product8(const Float8& a, const Float8& b, const Float8& c) {
#ifdef __FMA__
    return reinterpret_cast<Float8>(_mm256_fmadd_ps(
        reinterpret_cast<__m256>(a), reinterpret_cast<__m256>(b), reinterpret_cast<__m256>(c)));
#else
    return a * b + c;
#endif
}
/// The difference c - a b, rounded as in add_product8.
inline Float8 less_product8(const Float8& a, const Float8& b, const Float8& c) {
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

/// Eight points or directions.
struct Vec3x8 {
    Float8 x{}, y{}, z{};
};
inline Vec3x8 all8(Vec3 a) {
    return {all8(a.x), all8(a.y), all8(a.z)};
}
inline Vec3x8 operator-(const Vec3x8& a, const Vec3x8& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vec3x8 abs8(const Vec3x8& a) {
    return {abs8(a.x), abs8(a.y), abs8(a.z)};
}
inline Float8 dot8(const Vec3x8& a, const Vec3x8& b) {
    return add_product8(a.z, b.z, add_product8(a.y, b.y, a.x * b.x));
}
inline Vec3x8 cross8(const Vec3x8& a, const Vec3x8& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// The difference c - a s of vectors, with one factor s for each.
inline Vec3x8 less_product8(const Vec3x8& a, const Float8& s, const Vec3x8& c) {
    return {less_product8(a.x, s, c.x), less_product8(a.y, s, c.y), less_product8(a.z, s, c.z)};
}
/// The sum a s + c of vectors, with one factor s for each.
inline Vec3x8 add_product8(const Vec3x8& a, const Float8& s, const Vec3x8& c) {
    return {add_product8(a.x, s, c.x), add_product8(a.y, s, c.y), add_product8(a.z, s, c.z)};
}

}  // namespace covtrace
