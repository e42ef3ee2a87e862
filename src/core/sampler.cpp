#include "core/sampler.h"

#include <array>
#include <bit>

#include "core/hash.h"

namespace covtrace {

namespace {

constexpr uint32_t reverse_bits(uint32_t v) {
    v = (v << 16) | (v >> 16);
    v = ((v & 0x00ff00ffu) << 8) | ((v & 0xff00ff00u) >> 8);
    v = ((v & 0x0f0f0f0fu) << 4) | ((v & 0xf0f0f0f0u) >> 4);
    v = ((v & 0x33333333u) << 2) | ((v & 0xccccccccu) >> 2);
    return ((v & 0x55555555u) << 1) | ((v & 0xaaaaaaaau) >> 1);
}

/// Laine-Karras permutation with the constants of Vegdahl 2021: each bit is flipped depending on
/// the lower bits.
constexpr uint32_t laine_karras(uint32_t v, uint32_t seed) {
    v ^= v * 0x3d20adeau;
    v += seed;
    v *= (seed >> 16) | 1u;
    v ^= v * 0x05526c56u;
    v ^= v * 0x53a22864u;
    return v;
}

constexpr uint32_t owen_scramble(uint32_t v, uint32_t seed) {
    return reverse_bits(laine_karras(reverse_bits(v), seed));
}

/// Generator matrices of Sobol dimensions 2 to 5 (Joe and Kuo 2008, new-joe-kuo-6.21201): primitive
/// polynomial degree s, coefficients a, initial direction numbers m. Dimension 1 is bit reversal.
struct Polynomial {
    uint32_t s, a;
    std::array<uint32_t, 3> m;
};
constexpr std::array<Polynomial, 4> kPolynomials{
    {{1, 0, {1, 0, 0}}, {2, 1, {1, 3, 0}}, {3, 1, {1, 3, 1}}, {3, 2, {1, 1, 1}}}};

constexpr std::array<uint32_t, 32> direction_numbers(const Polynomial& p) {
    std::array<uint32_t, 32> v{};
    for (uint32_t i = 0; i < 32; ++i) {
        if (i < p.s) {
            v[i] = p.m[i] << (31 - i);
            continue;
        }
        v[i] = v[i - p.s] ^ (v[i - p.s] >> p.s);
        for (uint32_t k = 1; k < p.s; ++k)
            if ((p.a >> (p.s - 1 - k)) & 1u) v[i] ^= v[i - k];
    }
    return v;
}
constexpr std::array<std::array<uint32_t, 32>, 4> kDirections{
    direction_numbers(kPolynomials[0]), direction_numbers(kPolynomials[1]),
    direction_numbers(kPolynomials[2]), direction_numbers(kPolynomials[3])};

/// The products of each matrix with every byte of the index: 4 look-ups a number.
constexpr auto kByteTables = [] {
    std::array<std::array<std::array<uint32_t, 256>, 4>, 4> t{};
    for (size_t d = 0; d < 4; ++d)
        for (size_t byte = 0; byte < 4; ++byte)
            for (uint32_t value = 0; value < 256; ++value) {
                uint32_t x = 0;
                for (uint32_t bit = 0; bit < 8; ++bit)
                    if ((value >> bit) & 1u) x ^= kDirections[d][byte * 8 + bit];
                t[d][byte][value] = x;
            }
    return t;
}();

uint32_t sobol(uint32_t index, size_t dimension) {
    if (dimension == 0) return reverse_bits(index);
    const auto& t = kByteTables[dimension - 1];
    return t[0][index & 255] ^ t[1][(index >> 8) & 255] ^ t[2][(index >> 16) & 255] ^
           t[3][index >> 24];
}

}  // namespace

Sampler::Sampler(uint64_t seed, int pixel_x, int pixel_y, uint32_t sample_index)
    : key_(hash_combine(seed, static_cast<uint32_t>(pixel_x), static_cast<uint32_t>(pixel_y))),
      index_(sample_index) {}

Sampler::CameraSample Sampler::camera() {
    const uint32_t index =
        owen_scramble(index_, static_cast<uint32_t>(hash_combine(key_, 0x63616d)));
    std::array<float, 5> x{};
    for (size_t d = 0; d < 5; ++d) {
        const auto scramble = static_cast<uint32_t>(hash_combine(key_, 0x100 + d));
        x[d] = to_unit_float(owen_scramble(sobol(index, d), scramble));
    }
    return {{x[0], x[1]}, {x[2], x[3]}, x[4]};
}

Vec2 Sampler::next_2d() {
    const uint64_t key = hash_combine(key_, 0x1000 + pair_++);
    const uint32_t index = owen_scramble(index_, static_cast<uint32_t>(key));
    const uint64_t scrambles = mix_bits(key);
    return {to_unit_float(owen_scramble(sobol(index, 0), static_cast<uint32_t>(scrambles))),
            to_unit_float(owen_scramble(sobol(index, 1), static_cast<uint32_t>(scrambles >> 32)))};
}

float Sampler::next_1d() {
    const uint64_t key = hash_combine(key_, 0x1000 + pair_++);
    const uint32_t index = owen_scramble(index_, static_cast<uint32_t>(key));
    return to_unit_float(owen_scramble(sobol(index, 0), static_cast<uint32_t>(mix_bits(key))));
}

}  // namespace covtrace
