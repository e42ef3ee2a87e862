// Rare bright light: limited, given back, and where it goes.
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

/// An even image that pixels of `raw` are so much brighter than, on the grid of every `step`-th
/// pixel of the middle `side` ones; all others are off it by a tenth, up and down.
ColorPlanes after_return(int side, int step, float brighter) {
    ColorPlanes raw = constant(0), color = constant(1);
    for (Plane& p : raw)
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x) p(x, y) = (x + y) % 2 ? 1.1f : 0.9f;
    const int first = (kSize - side) / 2;
    for (Plane& p : raw)
        for (int y = first; y < first + side; y += step)
            for (int x = first; x < first + side; x += step) p(x, y) = 1 + brighter;
    const double before = mean_of(raw);
    return_energy(raw, color);
    EXPECT_NEAR(mean_of(color) / before, 1, 1e-4);
    return color;
}

TEST(Outliers, OnePathsLightMakesNoBlotch) {
    // Spread over 12 pixels it would be 0.22 at the middle; the wide Gaussian is cut by the border.
    const ColorPlanes color = after_return(1, 1, 200);
    const auto [least, most] = std::minmax_element(color[0].values.begin(), color[0].values.end());
    EXPECT_LT(*most - *least, 0.06f);
    EXPECT_GT(*least, 1.02f);
}

TEST(Outliers, ASmallLampDoesNotLightTheImage) {
    // One half saw a lamp 100000 times as bright as all else, in one pixel or in a few: spread over
    // 48 pixels it would drown the image.
    for (const int side : {1, 3}) {
        const ColorPlanes color = after_return(side, 1, 1e5f);
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x)
                if (std::max(std::abs(2 * x - kSize), std::abs(2 * y - kSize)) > 2 * side + 2) {
                    ASSERT_NEAR(color[0](x, y), 1, 0.25f) << side << " " << x << " " << y;
                }
        EXPECT_GT(color[0](kSize / 2 - 1, kSize / 2 - 1) + color[0](kSize / 2, kSize / 2), 9e4f);
    }
}

TEST(Outliers, RareNegativeLightIsLimited) {
    // As a pixel filter with negative lobes makes it beside a rare path.
    Halves halves = noisy_halves(kSize, kSize, smooth_truth, 0.1f, 5);
    for (Plane& p : halves[0].color) p(30, 30) = -500;
    limit_outliers(halves);
    EXPECT_GT(halves[0].color[0](30, 30), -5);
    EXPECT_LT(halves[0].color[0](30, 30), 0);
}

TEST(Outliers, LightThatManyPathsBringStaysNear) {
    // 36 pixels of 24 x 24: none brings more than a tenth of what the others do.
    const ColorPlanes color = after_return(24, 4, 200);
    const float middle = color[0](kSize / 2, kSize / 2), corner = color[0](1, 1);
    EXPECT_GT(middle, 4.0f);
    EXPECT_LT(corner - 1, 0.1f * (middle - 1));
}

}  // namespace
}  // namespace covtrace
