// How far the noise of neighbours is the same, measured from the halves.
#include "foreign/noise_correlation.h"

#include <gtest/gtest.h>

#include "reconstruction_fixtures.h"

namespace covtrace {
namespace {

using namespace test;

constexpr int kWide = 128, kHigh = 96;

Halves noise_halves(uint64_t seed) {
    return noisy_halves(
        kWide, kHigh, [](int x, int) { return x < 40 ? 0.1f : 2.0f; }, 0.4f, seed);
}

/// Each sample splat into a pixel and its neighbours to the right, below and both.
void splat(Halves& halves) {
    for (HalfBuffer& half : halves)
        for (Plane& p : half.color) {
            const Plane sharp = p;
            for (int y = 1; y < kHigh; ++y)
                for (int x = 1; x < kWide; ++x)
                    p(x, y) = 0.25f * (sharp(x, y) + sharp(x - 1, y) + sharp(x, y - 1) +
                                       sharp(x - 1, y - 1));
        }
}

TEST(NoiseCorrelation, PixelsWithNoiseOfTheirOwnHaveNone) {
    // Its deviation is 1 / sqrt(2 * 128 * 96) = 0.006: beyond 0.03 once in a million seeds.
    for (uint64_t seed : {1u, 2u, 3u, 4u})
        EXPECT_NEAR(neighbours_correlation(noise_halves(seed)), 0, 0.03f) << seed;
}

TEST(NoiseCorrelation, SplatSamplesShow) {
    for (uint64_t seed : {1u, 2u}) {
        Halves halves = noise_halves(seed);
        splat(halves);
        EXPECT_NEAR(neighbours_correlation(halves), 0.5f, 0.04f) << seed;
    }
}

TEST(NoiseCorrelation, NoBrightPathDecides) {
    Halves halves = noise_halves(5);
    for (Plane& p : halves[0].color)
        for (int x = 60; x < 64; ++x) p(x, 50) = 1e6f;
    EXPECT_NEAR(neighbours_correlation(halves), 0, 0.03f);
}

TEST(NoiseCorrelation, HalvesThatAreTheSameTellNothing) {
    Halves halves = noise_halves(6);
    halves[1] = halves[0];
    EXPECT_EQ(neighbours_correlation(halves), 0);
}

}  // namespace
}  // namespace covtrace
