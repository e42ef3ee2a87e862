/// Generator matrices of the first five Sobol dimensions (Joe and Kuo 2008, new-joe-kuo-6.21201).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace covtrace {

/// Generator matrices: [d][b] is what bit b of the index adds to the number of dimension d, a
/// fraction of 2^32.
using SobolDirections = std::array<std::array<uint32_t, 32>, 5>;

/// The matrices of Joe and Kuo. The first dimension is bit reversal, the others follow from
/// primitive polynomials: degree s, coefficients a, initial direction numbers m.
constexpr SobolDirections sobol_directions() {
    struct Polynomial {
        uint32_t s, a;
        std::array<uint32_t, 3> m;
    };
    constexpr std::array<Polynomial, 4> kPolynomials{
        {{1, 0, {1, 0, 0}}, {2, 1, {1, 3, 0}}, {3, 1, {1, 3, 1}}, {3, 2, {1, 1, 1}}}};
    SobolDirections directions{};
    for (uint32_t i = 0; i < 32; ++i) directions[0][i] = 1u << (31 - i);
    for (size_t d = 0; d < kPolynomials.size(); ++d) {
        const Polynomial& p = kPolynomials[d];
        std::array<uint32_t, 32>& v = directions[d + 1];
        for (uint32_t i = 0; i < 32; ++i) {
            if (i < p.s) {
                v[i] = p.m[i] << (31 - i);
                continue;
            }
            v[i] = v[i - p.s] ^ (v[i - p.s] >> p.s);
            for (uint32_t k = 1; k < p.s; ++k)
                if ((p.a >> (p.s - 1 - k)) & 1u) v[i] ^= v[i - k];
        }
    }
    return directions;
}

inline constexpr SobolDirections kSobolDirections = sobol_directions();

}  // namespace covtrace
