#include "viewer/encode_plane.h"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <new>
#include <optional>
#include <vector>

#include "core/base64.h"

namespace covtrace::viewer {

namespace {

/// The 16-bit float that is exactly `value`, if there is one; any NaN is one.
std::optional<uint16_t> exact_half(float value) {
    const uint32_t bits = std::bit_cast<uint32_t>(value);
    const auto sign = uint16_t(bits >> 16 & 0x8000u);
    if (std::isnan(value)) return uint16_t(sign | 0x7e00u);
    if (std::isinf(value)) return uint16_t(sign | 0x7c00u);
    const float size = std::abs(value);
    if (size == 0) return sign;
    if (size > 65504.0f) return std::nullopt;
    constexpr float kLeastNormal = 6.103515625e-05f;  // 2^-14
    if (size < kLeastNormal) {                        // a subnormal: a multiple of 2^-24
        const float steps = size * 16777216.0f;
        if (steps != std::floor(steps)) return std::nullopt;
        return uint16_t(sign | uint16_t(steps));
    }
    if (bits & 0x1fffu) return std::nullopt;  // more than ten bits behind the point
    const uint32_t exponent = (bits >> 23 & 0xffu) - 127 + 15;
    return uint16_t(sign | exponent << 10 | (bits >> 13 & 0x3ffu));
}

std::vector<uint8_t> deflated(std::span<const uint8_t> bytes) {
    constexpr int kLevel = 6;
    uLongf size = compressBound(bytes.size());
    std::vector<uint8_t> out(size);
    if (compress2(out.data(), &size, bytes.data(), bytes.size(), kLevel) != Z_OK)
        throw std::bad_alloc();  // the only failure with a buffer of this size
    out.resize(size);
    return out;
}

}  // namespace

EncodedPlane encode_plane(std::span<const float> values) {
    const size_t n = values.size();
    std::vector<uint8_t> bytes(2 * n);
    bool half = true;
    for (size_t i = 0; i < n && half; ++i) {
        const std::optional<uint16_t> h = exact_half(values[i]);
        half = h.has_value();
        for (size_t k = 0; k < 2 && half; ++k) bytes[k * n + i] = uint8_t(*h >> (8 * k));
    }
    if (!half) {
        bytes.resize(4 * n);
        for (size_t i = 0; i < n; ++i)
            for (size_t k = 0; k < 4; ++k)
                bytes[k * n + i] = uint8_t(std::bit_cast<uint32_t>(values[i]) >> (8 * k));
    }
    return {half, base64(deflated(bytes))};
}

}  // namespace covtrace::viewer
