/// Sums of products over arrays, for the normal equations of regressions.
#pragma once

#include <cstddef>

#include "core/simd.h"

namespace covtrace {

/// Sets result[i][j] to the sum over k < n of a[i][k] b[j][k]; n is a multiple of kLanes.
template <size_t Rows, size_t Columns>
inline void products(const float* const (&a)[Rows], const float* const (&b)[Columns], size_t n,
                     float (&result)[Rows][Columns]) {
    Float8 sum[Rows][Columns] = {};
    for (size_t k = 0; k < n; k += kLanes) {
        Float8 x[Rows];
        for (size_t i = 0; i < Rows; ++i) x[i] = load8(a[i] + k);
        for (size_t j = 0; j < Columns; ++j) {
            const Float8 y = load8(b[j] + k);
            for (size_t i = 0; i < Rows; ++i) sum[i][j] = multiply_add(x[i], y, sum[i][j]);
        }
    }
    for (size_t i = 0; i < Rows; ++i)
        for (size_t j = 0; j < Columns; ++j) result[i][j] = sum8(sum[i][j]);
}

}  // namespace covtrace
