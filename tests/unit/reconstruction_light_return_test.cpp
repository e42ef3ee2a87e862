// Light that filters lost: the part of it that comes back, and its places.
#include "reconstruction/light_return.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "reconstruction/luminance.h"
#include "reconstruction_images.h"

namespace covtrace {
namespace {

using namespace test;

/// Halves without features whose mean has the variance `variance`.
Halves halves_with(float variance) {
    Halves halves{HalfBuffer(kSize, kSize), HalfBuffer(kSize, kSize)};
    for (HalfBuffer& half : halves) {
        half.count = Plane(kSize, kSize, 4);
        half.color_variance.fill(Plane(kSize, kSize, 2 * variance));
    }
    return halves;
}

double mean_of_columns(const ColorPlanes& color, int x0, int x1) {
    double sum = 0;
    for (int y = 0; y < kSize; ++y)
        for (int x = x0; x < x1; ++x) sum += double(color[1](x, y));
    return sum / ((x1 - x0) * kSize);
}

TEST(LightReturn, LightStaysOnItsWall) {
    // The filters left half of a dark wall's light, and all of that of a bright window beside it.
    ColorPlanes raw, color;
    raw.fill(Plane(kSize, kSize));
    color = raw;
    for (size_t c = 0; c < 3; ++c)
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x) {
                const bool dark = x < kSize / 2;
                raw[c](x, y) = dark ? ((x + y) % 4 == 0 ? 0.4f : 0.0f) : 10.0f;
                color[c](x, y) = dark ? 0.05f : 10.0f;
            }
    LightReturn(halves_with(0.03f)).give_back(raw, color);
    EXPECT_NEAR(mean_of_columns(color, 0, kSize / 2 - 2), 0.1, 0.01);
    EXPECT_NEAR(mean_of_columns(color, kSize / 2 + 2, kSize), 10, 0.1);
}

TEST(LightReturn, RareLightOfAWallComesBack) {
    // One pixel in 25 of a dark wall has seen the light, so that the wall's mean is known to a
    // tenth; but the image has the same samples, smoothed, and lacks a tenth of that. A bright half
    // beside it lacks nothing.
    ColorPlanes raw, color;
    raw.fill(Plane(kSize, kSize, 5));
    color = raw;
    Halves halves = halves_with(0);
    constexpr float kLight = 0.1f, kOnes = 25, kPart = 0.9f;
    for (size_t c = 0; c < 3; ++c)
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize / 2; ++x) {
                raw[c](x, y) = (7 * x + 11 * y) % 25 == 0 ? kOnes * kLight : 0;
                color[c](x, y) = kPart * kLight;
                for (HalfBuffer& half : halves)
                    half.color_variance[c](x, y) = 2 * sqr(kLight) * kOnes;
            }
    const double wall = mean_of_columns(raw, 0, kSize / 2);
    LightReturn(halves).give_back(raw, color);
    EXPECT_NEAR(mean_of_columns(color, 0, kSize / 2 - 2) / wall, 1, 0.03);
    EXPECT_NEAR(mean_of_columns(color, kSize / 2 + 2, kSize), 5, 0.02);
}

TEST(LightReturn, TheWholeImageHasTheLightOfItsSamples) {
    const Halves halves = noisy_halves(kSize, kSize, smooth_truth, 0.5f, 3);
    const ColorPlanes raw = mean_of_both({halves[0].color, halves[1].color});
    ColorPlanes color = constant(0.7f);
    LightReturn(halves).give_back(raw, color);
    EXPECT_NEAR(mean_of_columns(color, 0, kSize) / mean_of_columns(raw, 0, kSize), 1, 0.01);
}

TEST(LightReturn, FewSamplesGiveLessOfWhatFewPlacesHave) {
    // The image lacks the light of four bright paths, a sum whose variance is a fourth of its
    // square: wide windows give 1 - k / 4 of it, k = 1 or 3, and the whole image some of the rest.
    constexpr float kLight = 40, kLacking = 4 * kLight / (kSize * kSize);
    ColorPlanes raw = constant(1);
    Halves halves = halves_with(0);
    for (const int x : {kSize / 4, 3 * kSize / 4})
        for (const int y : {kSize / 4, 3 * kSize / 4})
            for (size_t c = 0; c < 3; ++c) {
                raw[c](x, y) += kLight;
                halves[0].color_variance[c](x, y) = 4 * sqr(kLight);
            }
    const auto given = [&](float few) {
        ColorPlanes color = constant(1);
        LightReturn(halves, HalvesNoise::of_one_sequence, few).give_back(raw, color);
        return mean_of_columns(color, 0, kSize) - 1;
    };
    EXPECT_GT(given(0), 0.85 * kLacking);
    EXPECT_GT(given(1), 0.1 * kLacking);
    EXPECT_LT(given(1), 0.3 * kLacking);
    EXPECT_GT(given(0.3f), given(0.6f));
    // Beyond 4 times the noise the sum tells nothing
    EXPECT_LT(given(2), 0.02 * kLacking);
}

TEST(LightReturn, NothingBecomesNegative) {
    // A spot that no sample has seen stands in an image that is twice as bright as its samples.
    ColorPlanes raw, color;
    raw.fill(Plane(kSize, kSize, 0.01f));
    color.fill(Plane(kSize, kSize, 0.02f));
    for (size_t c = 0; c < 3; ++c)
        for (int y = kSize / 2 - 3; y <= kSize / 2 + 3; ++y)
            for (int x = kSize / 2 - 3; x <= kSize / 2 + 3; ++x) {
                raw[c](x, y) = 0;
                color[c](x, y) = 1;
            }
    LightReturn(halves_with(0)).give_back(raw, color);
    EXPECT_GE(*std::min_element(color[1].values.begin(), color[1].values.end()), 0);
}

TEST(LightReturn, WhatIsNegativeStays) {
    // Beside a lamp under a pixel filter with negative lobes; all around is half as bright as the
    // samples.
    ColorPlanes raw, color;
    raw.fill(Plane(kSize, kSize, 1));
    color.fill(Plane(kSize, kSize, 0.5f));
    for (size_t c = 0; c < 3; ++c) raw[c](20, 20) = color[c](20, 20) = -0.05f;
    LightReturn(halves_with(0.001f)).give_back(raw, color);
    EXPECT_GT(mean_of_columns(color, 30, kSize), 0.9);
    EXPECT_GE(color[1](20, 20), -0.0501f);
}

TEST(LightReturn, SumsThatAreNoNumbersGiveNothing) {
    ColorPlanes raw, color;
    raw.fill(Plane(kSize, kSize, 2e36f));
    color.fill(Plane(kSize, kSize, 1e36f));
    LightReturn(halves_with(0.001f)).give_back(raw, color);
    for (const Plane& channel : color)
        for (float v : channel.values) ASSERT_TRUE(std::isfinite(v));
}

TEST(LightReturn, NoiseIsNotGivenBack) {
    // The samples differ from the truth by noise alone: an image that is the truth hardly changes.
    const Halves halves = noisy_halves(kSize, kSize, smooth_truth, 0.5f, 4);
    const ColorPlanes raw = mean_of_both({halves[0].color, halves[1].color});
    ColorPlanes color = constant(0);
    for (Plane& p : color)
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x) p(x, y) = smooth_truth(x, y);
    LightReturn(halves).give_back(raw, color);
    EXPECT_LT(mean_squared_error(color, smooth_truth),
              0.005 * mean_squared_error(raw, smooth_truth));
}

TEST(LightReturn, ASmallLampDoesNotLightTheImage) {
    // One half saw a lamp 100000 times as bright as all else, in one pixel or in a few.
    for (const int side : {1, 3}) {
        ColorPlanes raw = constant(1), color = constant(1);
        const int first = (kSize - side) / 2;
        for (Plane& p : raw)
            for (int y = first; y < first + side; ++y)
                for (int x = first; x < first + side; ++x) p(x, y) = 1e5f;
        Halves halves = halves_with(1);
        for (size_t c = 0; c < 3; ++c)
            for (size_t i = 0; i < raw[c].size(); ++i)
                if (raw[c][i] > 1) halves[0].color_variance[c][i] = 4 * sqr(raw[c][i]);
        LightReturn(halves).give_back(raw, color);
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x)
                if (std::max(std::abs(2 * x - kSize), std::abs(2 * y - kSize)) > 2 * side + 2) {
                    ASSERT_NEAR(color[0](x, y), 1, 0.25f) << side << " " << x << " " << y;
                }
        EXPECT_GT(color[0](kSize / 2 - 1, kSize / 2 - 1) + color[0](kSize / 2, kSize / 2), 9e4f);
    }
}

TEST(LightReturn, NoiseBesideASmallLampStaysAway) {
    // A lamp of one pixel stays in place; the noise of the fog around it does not come back.
    ColorPlanes raw, color;
    raw.fill(Plane(kSize, kSize, 0.2f));
    color.fill(Plane(kSize, kSize, 0.1f));
    constexpr int kAt = kSize / 2;
    for (size_t c = 0; c < 3; ++c) {
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x) raw[c](x, y) = (x + y) % 4 == 0 ? 0.4f : 0.0f;
        raw[c](kAt, kAt) = 2e5f;
    }
    LightReturn(halves_with(0.03f)).give_back(raw, color);
    EXPECT_NEAR(color[1](kAt, kAt), 2e5f, 0.1f * 2e5f);
    for (int y = kAt - 3; y <= kAt + 3; ++y)
        for (int x = kAt - 3; x <= kAt + 3; ++x)
            if (x != kAt || y != kAt) EXPECT_NEAR(color[1](x, y), color[1](2, 2), 0.02f) << x << y;
}

TEST(LightReturn, OnePathsLightMakesNoBlotch) {
    ColorPlanes raw = constant(1), color = constant(1);
    Halves halves = halves_with(1e-4f);
    for (size_t c = 0; c < 3; ++c) {
        raw[c](kSize / 2, kSize / 2) = 200;
        // The half that saw the lamp knows by its spread that it is rare.
        halves[0].color_variance[c](kSize / 2, kSize / 2) = 4 * sqr(199.0f);
    }
    LightReturn(halves).give_back(raw, color);
    const auto [least, most] = std::minmax_element(color[0].values.begin(), color[0].values.end());
    EXPECT_LT(*most - *least, 0.06f);
    EXPECT_GT(*least, 1.02f);
}

TEST(LightReturn, RareLightLeavesNoHoles) {
    // One pixel in 49 has seen the light of 49, but none in a corner, where four should have, and
    // the image is right. The corner's samples have no variance: they know no more than others.
    ColorPlanes raw = constant(0), color = constant(1);
    Halves halves = halves_with(0);
    for (size_t c = 0; c < 3; ++c)
        for (int y = 3; y < kSize; y += 7)
            for (int x = 3; x < kSize; x += 7)
                if (x >= 14 || y >= 14) {
                    raw[c](x, y) = 49;
                    halves[0].color_variance[c](x, y) = 4 * sqr(49.0f);
                }
    LightReturn(halves).give_back(raw, color);
    const auto [least, most] = std::minmax_element(color[1].values.begin(), color[1].values.end());
    EXPECT_GT(*least, 0.8f);
    EXPECT_LT(*most, 1.2f);
}

/// Halves without noise but for a spot of `side` x `side` pixels in the middle, which A and B saw
/// as bright as told.
Halves halves_with_spot(int side, float a, float b) {
    Halves halves = halves_with(0);
    for (size_t k = 0; k < 2; ++k)
        for (Plane& p : halves[k].color) {
            p = Plane(kSize, kSize, 1);
            for (int y = 0; y < side; ++y)
                for (int x = 0; x < side; ++x) p(kSize / 2 + x, kSize / 2 + y) = k == 0 ? a : b;
        }
    set_variance_from_difference(halves);
    return halves;
}

/// Most that is given to any pixel of an image that lacks the spot.
float most_given(const Halves& halves, HalvesNoise noise) {
    ColorPlanes color = constant(1);
    LightReturn(halves, noise).give_back(mean_of_both({halves[0].color, halves[1].color}), color);
    return *std::max_element(color[1].values.begin(), color[1].values.end()) - 1;
}

TEST(LightReturn, LightOfOnePathIsUncertainWhereItIs) {
    // The spread over 13 x 13 pixels makes one bright path look certain among few pixels that are
    // alike; what both halves differ by in the same block does not.
    for (const float light : {2000.0f, 2e5f}) {
        Halves halves = halves_with_spot(1, light, 1);
        for (HalfBuffer& half : halves)
            for (int y = -1; y < 3; ++y)
                for (int x = -1; x < 3; ++x)
                    half.feature[3](kSize / 2 + x, kSize / 2 + y) = 1;  // a small thing by itself
        EXPECT_LT(most_given(halves, HalvesNoise::independent), 0.02f) << light;
        EXPECT_GT(most_given(halves, HalvesNoise::of_one_sequence), 1.0f) << light;
    }
}

TEST(LightReturn, LightThatBothHalvesSawStays) {
    EXPECT_NEAR(most_given(halves_with_spot(2, 1e5f, 1e5f), HalvesNoise::independent), 1e5f, 1e3f);
    // 1.2 and 0.8 of it: (e_A e_B) / e^2 = 0.96
    EXPECT_NEAR(most_given(halves_with_spot(2, 1.2e5f, 0.8e5f), HalvesNoise::independent), 0.96e5f,
                1e3f);
}

}  // namespace
}  // namespace covtrace
