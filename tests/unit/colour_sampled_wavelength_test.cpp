#include "colour/sampled_wavelength.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "colour/spectrum.h"
#include "pbrt_test_support.h"

namespace covtrace::test {
namespace {

/// The mean over all wavelengths of their weights times a factor.
template <typename Factor>
Rgb mean(Factor factor) {
    constexpr int kCount = 100000;
    std::array<double, 3> sum{};
    for (int i = 0; i < kCount; ++i) {
        const SampledWavelength w = sample_wavelength((float(i) + 0.5f) / kCount);
        for (int c = 0; c < 3; ++c)
            sum[size_t(c)] += double(w.weight[c]) * factor(w.nanometres) / kCount;
    }
    return {float(sum[0]), float(sum[1]), float(sum[2])};
}

TEST(SampledWavelength, AllOfThemAreWhite) {
    expect_near(mean([](float) { return 1.0; }), Rgb(1), 1e-3f);
}

TEST(SampledWavelength, FactorsHaveTheirColour) {
    const Spectrum s{{380, 480, 560, 620, 780}, {0.9f, 0.1f, 0.7f, 0.2f, 1}, false};
    expect_near(mean([&](float l) { return s.at(double(l)); }), reflectance_colour(s), 3e-3f);
}

TEST(SampledWavelength, LiesInVisibleLightAndIsNeverDark) {
    for (int i = 0; i <= 1000; ++i) {
        const SampledWavelength w = sample_wavelength(std::min(float(i) / 1000, 0x1.fffffep-1f));
        EXPECT_GE(w.nanometres, 380);
        EXPECT_LE(w.nanometres, 780);
        EXPECT_GT(luminance(w.weight), 0) << w.nanometres;
    }
}

}  // namespace
}  // namespace covtrace::test
