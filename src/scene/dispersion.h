/// How a glass' index of refraction depends on the wavelength.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace covtrace {

/// Indices over that at 587.6 nm, one every 5 nm of visible light, linear between them.
struct Dispersion {
    static constexpr float kFirst = 380, kStep = 5;  ///< nanometres
    static constexpr size_t kCount = 81;
    std::array<float, kCount> ratio{};
    /// The ratio at a wavelength in nanometres; beyond the first and last ones theirs.
    float at(float wavelength) const {
        const float x = std::clamp((wavelength - kFirst) / kStep, 0.0f, float(kCount - 1));
        const size_t i = std::min(static_cast<size_t>(x), kCount - 2);
        const float t = x - static_cast<float>(i);
        return (1 - t) * ratio[i] + t * ratio[i + 1];
    }
};

}  // namespace covtrace
