// Square images of kSize x kSize pixels, and the predicted spectrum that goes with them.
#pragma once

#include "covariance/covariance.hpp"
#include "reconstruction_fixtures.h"

namespace covtrace::test {

inline constexpr int kSize = 64;
/// The predicted spectrum of every pixel, (cycles per pixel)^2.
inline const std::vector<covariance::Sym2<float>> kSpectrum(size_t(kSize) * kSize,
                                                            {0.01f, 0, 0.01f});

inline float smooth_truth(int x, int y) {
    return 1 + 0.3f * std::sin(0.1f * float(x)) * std::cos(0.07f * float(y));
}

/// Truth of hard squares that no feature and no prediction knows of.
inline float checks(int x, int y) {
    return (x / 3 + y / 3) % 2 ? 1.0f : 0.2f;
}

inline ColorPlanes constant(float value) {
    ColorPlanes p;
    p.fill(Plane(kSize, kSize, value));
    return p;
}

inline ColorPlanes mean_of_both(const std::array<ColorPlanes, 2>& halves) {
    ColorPlanes mean = halves[0];
    for (size_t c = 0; c < 3; ++c)
        for (size_t i = 0; i < mean[c].size(); ++i)
            mean[c][i] = 0.5f * (mean[c][i] + halves[1][c][i]);
    return mean;
}

}  // namespace covtrace::test
