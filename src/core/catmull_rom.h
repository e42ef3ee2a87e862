/// Smooth curves through values one step apart, after Catmull and Rom ("A class of local
/// interpolating splines", 1974).
#pragma once

#include <array>

namespace covtrace {

/// Weights of four values one step apart, where `t` in [0, 1] lies between the second and the
/// third.
template <typename T>
constexpr std::array<T, 4> catmull_rom_weights(T t) {
    const T s = 1 - t, half = T(0.5), first = -half * t * s * s, last = -half * s * t * t;
    return {first, s - 2 * first + last, t - 2 * last + first, last};
}

}  // namespace covtrace
