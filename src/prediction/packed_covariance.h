/// A 5x5 covariance with its weight, packed into 40 bytes.
#pragma once

#include <array>
#include <cstdint>

#include "covariance/covariance.hpp"

namespace covtrace {

/// The factor L of S = L L^T (Cholesky), lens and shutter before the position, in 16 bits an entry
/// and an exponent for each row. Factors are kept because the integral over lens and shutter takes
/// differences of entries of S that are nearly equal where its axes are strongly correlated. With S
/// = [A B; B^T C] that difference is C - B^T A^-1 B = M M^T, M the last rows of L right of A's
/// columns, which are kept themselves: the difference has their relative precision however small it
/// is beside C, and never loses its sign.
///
/// The columns of A hold slopes, B^T A^-1. The difference of a mean of several such matrices
/// includes the squared differences of their slopes: slopes are kept to 2^-16 of the row, while the
/// diagonal and M have 11 and 10 bits after the leading one and a range of 2^31. Entries of S come
/// back to 2^-10 of sqrt(S_ii S_jj), docs/decisions/0052 and 0056.
struct PackedCovariance {
    std::array<uint16_t, 15> factor{};  ///< row by row
    std::array<int8_t, 5> exponent{};
    uint8_t unused = 0;
    float weight = 0;

    PackedCovariance() = default;
    /// Packs `s`, which is positive semidefinite but for the rounding of doubles.
    PackedCovariance(const covariance::SymmetricMatrix5<double>& s, float weight_of_it);
    covariance::SymmetricMatrix5<double> covariance() const;
};
static_assert(sizeof(PackedCovariance) == 40);

}  // namespace covtrace
