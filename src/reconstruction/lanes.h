/// Sums of products over arrays, eight at a time in a fixed order: a build gives the same bits on
/// any machine.
#pragma once

#ifdef __FMA__
#include <immintrin.h>
#endif

#include <cstddef>
#include <cstdint>
#include <cstring>

// How such vectors are passed depends on the processor that is compiled for, which is one for all
// of the program.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace covtrace {

constexpr size_t kLanes = 8;
/// Eight floats that are worked on together (a vector type of GCC and Clang).
using Lanes = float __attribute__((vector_size(kLanes * sizeof(float))));

inline Lanes load(const float* from) {
    Lanes v;
    std::memcpy(&v, from, sizeof v);
    return v;
}
inline void store(const Lanes& v, float* to) {
    std::memcpy(to, &v, sizeof v);
}
/// a b + c, rounded once where the processor that is compiled for can.
inline Lanes multiply_add(const Lanes& a, const Lanes& b, const Lanes& c) {
#ifdef __FMA__
    return _mm256_fmadd_ps(a, b, c);
#else
    return a * b + c;
#endif
}
inline Lanes smaller(const Lanes& a, const Lanes& b) {
    return a < b ? a : b;
}

/// exp(x) for x <= 0, to 5e-6 of it; below -80 it stays that of -80: nothing. 2^x is the power of
/// its nearest integer, put into the exponent's bits, times a polynomial of the rest.
inline Lanes exp_of_negative(const Lanes& x) {
    using Integers = uint32_t __attribute__((vector_size(sizeof(Lanes))));
    constexpr float kLog2E = 1.44269504f, kRounder = 12582912.0f;  // 1.5 * 2^23
    const Lanes power = kLog2E * (x < -80.0f ? -80.0f - Lanes{} : x);
    const Lanes rounded = power + kRounder, rest = power - (rounded - kRounder);
    Integers bits;
    std::memcpy(&bits, &rounded, sizeof bits);
    bits = (bits + 127) << 23;
    Lanes scale;
    std::memcpy(&scale, &bits, sizeof scale);
    // Taylor's of 2^rest, |rest| <= 1/2.
    Lanes sum = 1.5403530e-4f - Lanes{};
    for (float c :
         {1.3333558e-3f, 9.6181291e-3f, 5.5504109e-2f, 2.4022651e-1f, 6.9314718e-1f, 1.0f})
        sum = multiply_add(sum, rest, c - Lanes{});
    return sum * scale;
}

/// The sum of all eight.
inline float total(const Lanes& s) {
    return ((s[0] + s[4]) + (s[1] + s[5])) + ((s[2] + s[6]) + (s[3] + s[7]));
}

/// result[i][j] = sum over k < n of a[i][k] b[j][k]; n a multiple of kLanes.
template <size_t Rows, size_t Columns>
inline void products(const float* const (&a)[Rows], const float* const (&b)[Columns], size_t n,
                     float (&result)[Rows][Columns]) {
    Lanes sum[Rows][Columns] = {};
    for (size_t k = 0; k < n; k += kLanes) {
        Lanes x[Rows];
        for (size_t i = 0; i < Rows; ++i) x[i] = load(a[i] + k);
        for (size_t j = 0; j < Columns; ++j) {
            const Lanes y = load(b[j] + k);
            for (size_t i = 0; i < Rows; ++i) sum[i][j] = multiply_add(x[i], y, sum[i][j]);
        }
    }
    for (size_t i = 0; i < Rows; ++i)
        for (size_t j = 0; j < Columns; ++j) result[i][j] = total(sum[i][j]);
}

}  // namespace covtrace
