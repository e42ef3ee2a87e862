/// Sums of products over arrays, eight at a time in a fixed order: the same bits on any machine.
#pragma once

#include <cstddef>
#include <cstring>

namespace covtrace {

constexpr size_t kLanes = 8;
/// Eight floats that are worked on together (a vector type of GCC and Clang).
using Lanes = float __attribute__((vector_size(kLanes * sizeof(float))));

/// result[i][j] = sum over k < n of a[i][k] b[j][k]; n a multiple of kLanes.
template <size_t Rows, size_t Columns>
inline void products(const float* const (&a)[Rows], const float* const (&b)[Columns], size_t n,
                     float (&result)[Rows][Columns]) {
    Lanes sum[Rows][Columns] = {};
    for (size_t k = 0; k < n; k += kLanes) {
        Lanes x[Rows];
        for (size_t i = 0; i < Rows; ++i) std::memcpy(&x[i], a[i] + k, sizeof(Lanes));
        for (size_t j = 0; j < Columns; ++j) {
            Lanes y;
            std::memcpy(&y, b[j] + k, sizeof y);
            for (size_t i = 0; i < Rows; ++i) sum[i][j] += x[i] * y;
        }
    }
    for (size_t i = 0; i < Rows; ++i)
        for (size_t j = 0; j < Columns; ++j) {
            const Lanes s = sum[i][j];
            result[i][j] = ((s[0] + s[4]) + (s[1] + s[5])) + ((s[2] + s[6]) + (s[3] + s[7]));
        }
}

}  // namespace covtrace
