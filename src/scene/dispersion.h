/// How a glass' index of refraction depends on the wavelength.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>

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

/// The dispersion of what has index(nanometres), in [1e-6, 1e6], and `eta` at 587.6 nm; null where
/// all wavelengths have one.
template <typename Index>
std::shared_ptr<const Dispersion> dispersion_of(const Index& index, float eta) {
    Dispersion d;
    for (size_t i = 0; i < d.ratio.size(); ++i)
        d.ratio[i] = index(d.kFirst + d.kStep * static_cast<float>(i)) / eta;
    const bool varies =
        std::any_of(d.ratio.begin(), d.ratio.end(), [&](float r) { return r != d.ratio[0]; });
    return varies ? std::make_shared<const Dispersion>(d) : nullptr;
}

}  // namespace covtrace
