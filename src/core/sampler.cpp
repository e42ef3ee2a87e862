#include "core/sampler.h"

#include <array>
#include <bit>

#include "core/hash.h"
#include "core/sobol.h"

namespace covtrace {

namespace {

constexpr uint32_t reverse_bits(uint32_t v) {
    v = (v << 16) | (v >> 16);
    v = ((v & 0x00ff00ffu) << 8) | ((v & 0xff00ff00u) >> 8);
    v = ((v & 0x0f0f0f0fu) << 4) | ((v & 0xf0f0f0f0u) >> 4);
    v = ((v & 0x33333333u) << 2) | ((v & 0xccccccccu) >> 2);
    return ((v & 0x55555555u) << 1) | ((v & 0xaaaaaaaau) >> 1);
}

/// Laine-Karras permutation with the constants of Vegdahl 2021: each bit is flipped or not by a
/// hash of the lower bits.
constexpr uint32_t laine_karras(uint32_t v, uint32_t seed) {
    v ^= v * 0x3d20adeau;
    v += seed;
    v *= (seed >> 16) | 1u;
    v ^= v * 0x05526c56u;
    v ^= v * 0x53a22864u;
    return v;
}

/// Products of each generator matrix with every byte of the index, bits reversed: 4 look-ups a
/// number.
constexpr auto kByteTables = [] {
    std::array<std::array<std::array<uint32_t, 256>, 4>, 4> t{};
    for (size_t d = 0; d < 4; ++d)
        for (size_t byte = 0; byte < 4; ++byte)
            for (uint32_t value = 0; value < 256; ++value) {
                uint32_t x = 0;
                for (uint32_t bit = 0; bit < 8; ++bit)
                    if ((value >> bit) & 1u) x ^= kSobolDirections[d + 1][byte * 8 + bit];
                t[d][byte][value] = reverse_bits(x);
            }
    return t;
}();

/// Sobol numbers with their bits reversed, which is how they are scrambled; the first dimension is
/// the index itself.
uint32_t reversed_sobol(uint32_t index, size_t dimension) {
    if (dimension == 0) return index;
    const auto& t = kByteTables[dimension - 1];
    return t[0][index & 255] ^ t[1][(index >> 8) & 255] ^ t[2][(index >> 16) & 255] ^
           t[3][index >> 24];
}

/// Reversed Sobol numbers of the second dimension without tables, for loops that become vector
/// instructions: the matrix is Pascal's triangle modulo 2, a product of five shifts.
constexpr uint32_t reversed_sobol_1(uint32_t index) {
    index ^= index >> 16;
    index ^= (index >> 8) & 0x00ff00ffu;
    index ^= (index >> 4) & 0x0f0f0f0fu;
    index ^= (index >> 2) & 0x33333333u;
    return index ^ ((index >> 1) & 0x55555555u);
}

/// Binary logarithm of a tile's width in pixels.
constexpr uint32_t kTileBits = 4;

constexpr uint32_t reversed_morton_code(int x, int y) {
    uint32_t code = 0;
    for (uint32_t bit = 0; bit < kTileBits; ++bit)
        code = code << 2 | ((static_cast<uint32_t>(x) >> bit) & 1u) << 1 |
               ((static_cast<uint32_t>(y) >> bit) & 1u);
    return code;
}

/// Shifts of the sample index by pixel: each pixel adds, by its reversed Morton code, a sum of one
/// pattern for each bit of the code, lowest first. With them, samples 0 to 2^a - 1 of the 2^c
/// pixels of an aligned block are nearly a net of 2^(a + c) points for all a and c; found by
/// pixel_shifts (bench/sweeps, docs/decisions/0079).
using Patterns = std::array<uint32_t, 2 * kTileBits>;
constexpr std::array<uint32_t, 1u << 2 * kTileBits> pixel_shifts(const Patterns& patterns) {
    std::array<uint32_t, 1u << 2 * kTileBits> shifts{};
    for (uint32_t code = 0; code < shifts.size(); ++code)
        for (uint32_t bit = 0; bit < 2 * kTileBits; ++bit)
            if ((code >> (2 * kTileBits - 1 - bit)) & 1u) shifts[code] ^= patterns[bit];
    return shifts;
}
constexpr auto kPairShifts =
    pixel_shifts({0x7efe, 0x5191, 0x583b, 0x5323, 0x03eb, 0x1d86, 0x535e, 0x65da});
constexpr auto kCameraShifts =
    pixel_shifts({0x1c57, 0x0ae9, 0x0124, 0x0cdf, 0x1f7d, 0x0d81, 0x01d8, 0x0dcb});

/// Hash keys of the camera's dimensions: for their index, and the first of their scrambles.
constexpr uint64_t kCameraIndex = 0x63616d, kCameraScramble = 0x100;

/// A scrambled number in [0, 1) from a Sobol number with reversed bits.
constexpr float scrambled(uint32_t reversed, uint32_t seed) {
    return to_unit_float(reverse_bits(laine_karras(reversed, seed)));
}

}  // namespace

Sampler::Sampler(uint64_t seed, int pixel_x, int pixel_y, uint32_t sample_index)
    : key_(hash_combine(seed, static_cast<uint32_t>(pixel_x >> kTileBits),
                        static_cast<uint32_t>(pixel_y >> kTileBits))),
      reversed_index_(reverse_bits(sample_index)),
      pixel_(reversed_morton_code(pixel_x, pixel_y)) {}

/// The place in the sequence of this sample's number for `key`. Each pixel takes the numbers of
/// each key in an order of its own, so that no two keys go together throughout a tile; but the
/// first 2^a samples of all pixels stay the first 2^a indices. Pixels change places with each
/// other, block by block, in the same way.
uint32_t Sampler::index(uint64_t key, const PixelShifts& shifts) const {
    const uint32_t order = static_cast<uint32_t>(key) + pixel_ * 0x9e3779b1u;
    const uint32_t place = laine_karras(pixel_, static_cast<uint32_t>(key >> 32)) % shifts.size();
    return reverse_bits(laine_karras(reversed_index_, order) ^ laine_karras(0, order)) ^
           shifts[place];
}

Sampler::CameraSample Sampler::camera() {
    constexpr size_t kLanes = 8;  // five are used
    const uint32_t at = index(hash_combine(key_, kCameraIndex), kCameraShifts);
    std::array<uint32_t, kLanes> number{}, scramble{};
    for (size_t d = 0; d < 5; ++d) {
        scramble[d] = static_cast<uint32_t>(hash_combine(key_, kCameraScramble + d));
        number[d] = reversed_sobol(at, d);
    }
    std::array<float, kLanes> x;
    for (size_t d = 0; d < kLanes; ++d) x[d] = scrambled(number[d], scramble[d]);
    return {{x[0], x[1]}, {x[2], x[3]}, x[4]};
}

Vec2 Sampler::film() const {
    const uint32_t at = index(hash_combine(key_, kCameraIndex), kCameraShifts);
    const auto scramble = [this](uint64_t d) {
        return static_cast<uint32_t>(hash_combine(key_, kCameraScramble + d));
    };
    return {scrambled(at, scramble(0)), scrambled(reversed_sobol_1(at), scramble(1))};
}

Vec2 Sampler::next_2d() {
    return pair(pair_++);
}

Vec2 Sampler::pair(uint32_t number) const {
    const uint64_t key = hash_combine(key_, kFirstPair + number);
    const uint32_t at = index(key, kPairShifts);
    const uint64_t scrambles = mix_bits(key);
    return {scrambled(at, static_cast<uint32_t>(scrambles)),
            scrambled(reversed_sobol_1(at), static_cast<uint32_t>(scrambles >> 32))};
}

std::array<Vec2, 4> Sampler::next_four_2d() {
    std::array<uint64_t, 4> keys;
    std::array<uint32_t, 8> number, scramble;  // all first coordinates, then all second ones
    for (size_t i = 0; i < 4; ++i) {
        const uint64_t key = hash_combine(key_, kFirstPair + pair_++);
        const uint64_t scrambles = mix_bits(key);
        keys[i] = key;
        scramble[i] = static_cast<uint32_t>(scrambles);
        scramble[i + 4] = static_cast<uint32_t>(scrambles >> 32);
    }
    for (size_t i = 0; i < 4; ++i) {
        number[i] = index(keys[i], kPairShifts);
        number[i + 4] = reversed_sobol_1(number[i]);
    }
    std::array<float, 8> x;
    for (size_t i = 0; i < 8; ++i) x[i] = scrambled(number[i], scramble[i]);
    return {{{x[0], x[4]}, {x[1], x[5]}, {x[2], x[6]}, {x[3], x[7]}}};
}

float Sampler::next_1d() {
    return next_2d().x;
}

}  // namespace covtrace
