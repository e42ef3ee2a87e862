/// Integer hashes for random numbers that depend on nothing but their arguments.
#pragma once

#include <bit>
#include <cstdint>

namespace covtrace {

/// Finaliser of SplitMix64 (Steele, Lea and Flood 2014, "Fast splittable pseudorandom number
/// generators"): a bijection on 64 bits.
constexpr uint64_t mix_bits(uint64_t v) {
    v ^= v >> 30;
    v *= 0xbf58476d1ce4e5b9ull;
    v ^= v >> 27;
    v *= 0x94d049bb133111ebull;
    return v ^ (v >> 31);
}
constexpr uint64_t hash_combine(uint64_t a, uint64_t b) {
    return mix_bits(a * 0x9e3779b97f4a7c15ull + b + 0x632be59bd9b4e019ull);
}
template <typename... More>
constexpr uint64_t hash_combine(uint64_t a, uint64_t b, More... more) {
    return hash_combine(hash_combine(a, b), static_cast<uint64_t>(more)...);
}
/// Largest number that `to_unit_float` gives.
inline constexpr float kLargestBelowOne = 1 - 0x1p-24f;
/// A number in [0, 1) made of the upper 24 bits.
constexpr float to_unit_float(uint32_t bits) {
    return static_cast<float>(bits >> 8) * 0x1p-24f;
}

}  // namespace covtrace
