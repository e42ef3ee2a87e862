/// Cosine-weighted means over the hemisphere.
#pragma once

#include <array>
#include <cstddef>

namespace covtrace {

/// The mean of f(cosine), a number or a colour, weighted by the cosine to the normal: by Gauss and
/// Legendre's five nodes over the cosine, of a smooth border's reflectance within 0.001.
template <typename F>
auto hemisphere_mean(const F& f) {
    constexpr std::array<float, 5> kCosines{0.046910077f, 0.23076534f, 0.5f, 0.76923466f,
                                            0.95308992f};
    constexpr std::array<float, 5> kWeights{0.11846344f, 0.23931434f, 0.28444444f, 0.23931434f,
                                            0.11846344f};
    decltype(f(1.0f)) sum{};
    for (size_t i = 0; i < kCosines.size(); ++i)
        sum += f(kCosines[i]) * (2 * kCosines[i] * kWeights[i]);
    return sum;
}

}  // namespace covtrace
