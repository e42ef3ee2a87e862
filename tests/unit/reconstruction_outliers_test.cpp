// Rare bright light: limited, given back, and its places afterwards.
#include "reconstruction/outliers.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "reconstruction/hybrid.h"
#include "reconstruction_images.h"

namespace covtrace {
namespace {

using namespace test;

TEST(Outliers, EnergyIsKeptAndThePeakIsGone) {
    const auto one = [](int, int) { return 1.0f; };
    Halves halves = noisy_halves(kSize, kSize, one, 0.1f, 4);
    for (size_t c = 0; c < 3; ++c) halves[0].color[c](31, 33) = 500;
    const double before = 0.5 * (mean_of(halves[0].color) + mean_of(halves[1].color));
    const HybridImage image = reconstruct(halves, kSpectrum);
    EXPECT_NEAR(mean_of(image.color) / before, 1, 2e-3);
    float brightest = 0;
    for (float v : image.color[0].values) brightest = std::max(brightest, v);
    EXPECT_LT(brightest, 2.0f);
}

TEST(Outliers, WhatBothHalvesSeeStays) {
    const auto lamp = [](int x, int y) { return x == 30 && y == 30 ? 500.0f : 1.0f; };
    Halves halves = noisy_halves(kSize, kSize, lamp, 0.1f, 5);
    limit_outliers(halves);
    EXPECT_NEAR(halves[0].color[0](30, 30), 500, 1);
    const HybridImage image = reconstruct(halves, kSpectrum);
    EXPECT_NEAR(image.color[0](30, 30), 500, 25);
}

TEST(Outliers, RareNegativeLightIsLimited) {
    // The pixel is as a pixel filter with negative lobes makes it beside a rare path.
    Halves halves = noisy_halves(kSize, kSize, smooth_truth, 0.1f, 5);
    for (Plane& p : halves[0].color) p(30, 30) = -500;
    limit_outliers(halves);
    EXPECT_GT(halves[0].color[0](30, 30), -5);
    EXPECT_LT(halves[0].color[0](30, 30), 0);
}

}  // namespace
}  // namespace covtrace
