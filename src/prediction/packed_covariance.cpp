#include "prediction/packed_covariance.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace covtrace {

namespace {

// Order of the axes: lens, shutter, position.
constexpr std::array<size_t, 5> kOrder{2, 3, 4, 0, 1};
constexpr size_t kIntegrated = 3;  // number of these axes that are integrated over, the first ones

/// Index of entry (i, j), j <= i, of the factor.
size_t entry(size_t i, size_t j) {
    return i * (i + 1) / 2 + j;
}

/// Codes of numbers from 2^-32 to 1/2, with `mantissa` bits after the leading one, as the upper
/// bits of floats; anything below becomes 0.
template <int mantissa>
struct Scaled {
    static constexpr uint32_t kLowest = uint32_t{127 - 32} << 23;
    static constexpr int kDropped = 23 - mantissa;

    static uint16_t encode(float v) {
        const uint32_t bits = std::bit_cast<uint32_t>(v);
        return bits <= kLowest ? uint16_t(0)
                               : uint16_t((bits - kLowest + (1u << (kDropped - 1))) >> kDropped);
    }
    static float decode(uint16_t code) {
        return code == 0 ? 0.0f : std::bit_cast<float>((uint32_t{code} << kDropped) + kLowest);
    }
};

/// The code of the number v, at most 1/2 in size, at (i, j).
uint16_t encode(size_t i, size_t j, double v) {
    if (i == j) return std::min(Scaled<11>::encode(float(v)), uint16_t(0xf7ff));
    if (j < kIntegrated)
        return uint16_t(int16_t(std::clamp(std::lround(v * 65536), -32767l, 32767l)));
    return uint16_t(Scaled<10>::encode(float(std::abs(v))) | (v < 0 ? 0x8000u : 0u));
}

double decode(size_t i, size_t j, uint16_t code) {
    if (i == j) return Scaled<11>::decode(code);
    if (j < kIntegrated) return double(int16_t(code)) / 65536;
    const float v = Scaled<10>::decode(code & 0x7fffu);
    return code & 0x8000u ? -v : v;
}

using Factor = std::array<double, 15>;

Factor cholesky(const covariance::SymmetricMatrix5<double>& s) {
    // Share of a variance below which a pivot is what the rounding of S left: nothing follows from
    // it.
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
    // Factors by which rounding changed the diagonal entries: entries below follow them, which
    // keeps their slopes.
    std::array<double, 5> rounded{1, 1, 1, 1, 1};
    for (size_t i = 0; i < 5; ++i) {
        std::array<double, 5> row{};
        double largest = 0;
        for (size_t j = 0; j <= i; ++j) {
            row[j] = l[entry(i, j)] * rounded[j];
            largest = std::max(largest, std::abs(row[j]));
        }
        if (!(largest > 0) || !std::isfinite(largest)) continue;
        // The exponent is so large that entries are below 1/2.
        exponent[i] = int8_t(std::clamp(std::ilogb(largest) + 2, -120, 120));
        const double scale = std::ldexp(1.0, -exponent[i]);
        for (size_t j = 0; j <= i; ++j)
            factor[entry(i, j)] = encode(i, j, std::clamp(row[j] * scale, -0.5, 0.5));
        if (const double kept = decode(i, i, factor[entry(i, i)]); kept > 0)
            rounded[i] = kept / (row[i] * scale);
    }
}

covariance::SymmetricMatrix5<double> PackedCovariance::covariance() const {
    Factor l{};
    for (size_t i = 0; i < 5; ++i)
        for (size_t j = 0; j <= i; ++j)
            l[entry(i, j)] = std::ldexp(decode(i, j, factor[entry(i, j)]), int(exponent[i]));
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
