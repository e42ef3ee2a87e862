/// The sRGB transfer curve (IEC 61966-2-1), piecewise and exact: no pure power approximation.
#pragma once

#include <cmath>
#include <cstdint>

namespace covtrace {

/// Display value (sRGB) of a linear value, both 1 at white. Defined for all finite values: linear
/// below the toe, also for negative ones, and continuing above 1.
inline float srgb_encode(float linear) {
    return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
}

/// Linear value of a display value (sRGB): the inverse of `srgb_encode`.
inline float srgb_decode(float encoded) {
    return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

/// 8-bit display value of a linear one, clamped to [0, 1] and rounded to nearest; NaN gives 0.
inline uint8_t srgb_encode_8bit(float linear) {
    if (!(linear > 0)) return 0;
    if (linear >= 1) return 255;
    return uint8_t(255.0f * srgb_encode(linear) + 0.5f);
}

}  // namespace covtrace
