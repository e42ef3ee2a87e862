#include "planner/packed_covariance.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace covtrace {

namespace {

constexpr std::array<size_t, 5> kOrder{2, 3, 4, 0, 1};  // lens, shutter, position

/// Place of entry (i, j), j <= i, of the factor.
size_t entry(size_t i, size_t j) {
    return i * (i + 1) / 2 + j;
}

// Numbers below 1/2 from 2^-32 on, as the upper bits of floats.
constexpr uint32_t kLowest = uint32_t{127 - 32} << 23;
constexpr int kDropped = 13;  // bits of the mantissa

uint16_t encode(float v) {
    const uint32_t bits = std::bit_cast<uint32_t>(std::abs(v));
    if (bits <= kLowest) return 0;
    const uint32_t rounded = (bits - kLowest + (1u << (kDropped - 1))) >> kDropped;
    return uint16_t(rounded | (v < 0 ? 0x8000u : 0u));
}

float decode(uint16_t code) {
    const uint32_t size = code & 0x7fffu;
    if (size == 0) return 0;
    const float v = std::bit_cast<float>((size << kDropped) + kLowest);
    return code & 0x8000u ? -v : v;
}

using Factor = std::array<double, 15>;

Factor cholesky(const covariance::SymmetricMatrix5<double>& s) {
    // Less than this share of a variance is what the rounding of S left: nothing follows from it.
    constexpr double kRounding = 1e-12;
    Factor l{};
    for (size_t j = 0; j < 5; ++j) {
        const double variance = s(kOrder[j], kOrder[j]);
        double pivot = variance;
        for (size_t k = 0; k < j; ++k) pivot -= l[entry(j, k)] * l[entry(j, k)];
        if (!(pivot > 0)) continue;
        const double root = std::sqrt(pivot);
        l[entry(j, j)] = root;
        if (pivot <= kRounding * variance) continue;
        for (size_t i = j + 1; i < 5; ++i) {
            double sum = s(kOrder[i], kOrder[j]);
            for (size_t k = 0; k < j; ++k) sum -= l[entry(i, k)] * l[entry(j, k)];
            l[entry(i, j)] = sum / root;
        }
    }
    return l;
}

}  // namespace

PackedCovariance::PackedCovariance(const covariance::SymmetricMatrix5<double>& s,
                                   float weight_of_it)
    : weight(weight_of_it) {
    const Factor l = cholesky(s);
    for (size_t i = 0; i < 5; ++i) {
        double largest = 0;
        for (size_t j = 0; j <= i; ++j) largest = std::max(largest, std::abs(l[entry(i, j)]));
        if (!(largest > 0) || !std::isfinite(largest)) continue;
        // Entries are below 1/2 then, rounding included.
        exponent[i] = int8_t(std::clamp(std::ilogb(largest) + 2, -120, 120));
        const double scale = std::ldexp(1.0, -exponent[i]);
        for (size_t j = 0; j <= i; ++j)
            factor[entry(i, j)] = encode(float(std::clamp(l[entry(i, j)] * scale, -0.5, 0.5)));
    }
}

covariance::SymmetricMatrix5<double> PackedCovariance::covariance() const {
    Factor l{};
    for (size_t i = 0; i < 5; ++i)
        for (size_t j = 0; j <= i; ++j)
            l[entry(i, j)] = std::ldexp(double(decode(factor[entry(i, j)])), int(exponent[i]));
    covariance::SymmetricMatrix5<double> s;
    for (size_t i = 0; i < 5; ++i)
        for (size_t j = 0; j <= i; ++j) {
            double sum = 0;
            for (size_t k = 0; k <= j; ++k) sum += l[entry(i, k)] * l[entry(j, k)];
            s(kOrder[i], kOrder[j]) = sum;
        }
    return s;
}

}  // namespace covtrace
