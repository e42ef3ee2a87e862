// Dim images are brought to the brightness of displays, images in usual units stay as they are; of
// unknown units bright ones are, too.
#include "core/display_exposure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace covtrace {
namespace {

constexpr int kSize = 80;

/// The exposure of an image of this brightness everywhere.
float of_constant(float brightness) {
    return display_exposure(Plane(kSize, kSize, brightness));
}

TEST(DisplayExposure, LeavesImagesInUsualUnitsAsTheyAre) {
    for (const float brightness : {0.1f, 0.4f, 1.0f, 1e4f}) EXPECT_EQ(of_constant(brightness), 1);
    EXPECT_EQ(of_constant(0), 1);
}

TEST(DisplayExposure, BringsDimImagesToTheSameBrightness) {
    for (float brightness = 0.025f; brightness > 1e-6f; brightness *= 0.7f) {
        const float factor = of_constant(brightness);
        EXPECT_GT(factor * brightness, 0.2f * 0.999f) << brightness;
        EXPECT_LE(factor * brightness, 0.4f * 1.001f) << brightness;
        EXPECT_EQ(of_constant(brightness / 2), 2 * factor) << brightness;
    }
}

TEST(DisplayExposure, IsAPowerOfTwoThatGrowsSteadily) {
    float before = 1;
    for (float brightness = 0.2f; brightness > 1e-12f; brightness *= 0.97f) {
        const float factor = of_constant(brightness);
        EXPECT_EQ(std::exp2(std::round(std::log2(factor))), factor);
        EXPECT_GE(factor, before);
        EXPECT_LE(factor, 2 * before);
        before = factor;
    }
    EXPECT_EQ(before, 0x1p20f);
}

TEST(DisplayExposure, GoesByTheBrightestTenthOfWhatHasLight) {
    // Half of the image is black, a twentieth of the rest is a window.
    Plane image(kSize, kSize);
    for (int y = 0; y < kSize / 2; ++y)
        for (int x = 0; x < kSize; ++x) image(x, y) = x < kSize / 20 ? 1e4f : 1e-3f;
    EXPECT_EQ(display_exposure(image), of_constant(1e-3f));
    for (int y = 0; y < kSize / 2; ++y)
        for (int x = 0; x < kSize / 4; ++x) image(x, y) = 0.4f;
    EXPECT_EQ(display_exposure(image), 1);
}

TEST(DisplayExposure, KnowsRareLight) {
    // One pixel of 64 has met a path, which carries the light of all of them.
    Plane image(kSize, kSize);
    for (int y = 3; y < kSize; y += 8)
        for (int x = 3; x < kSize; x += 8) image(x, y) = 64 * 0.2f;
    EXPECT_EQ(display_exposure(image), 1);
}

TEST(DisplayExposure, KeepsTheSquaresOfLampsFinite) {
    for (const float lamp : {1e9f, 1e12f, 1e14f, 1e17f, 3e38f, -1e14f}) {
        Plane image(kSize, kSize, 1e-7f);
        image(20, 30) = lamp;
        const float factor = display_exposure(image);
        EXPECT_EQ(std::exp2(std::round(std::log2(factor))), factor) << lamp;
        EXPECT_GE(factor, 1) << lamp;
        if (factor > 1) EXPECT_LE(std::abs(lamp) * factor, 1e15f) << lamp;
        if (lamp == 1e9f) EXPECT_EQ(factor, 0x1p19f);
        if (lamp > 1e15f) EXPECT_EQ(factor, 1) << lamp;
    }
}

TEST(DisplayExposure, OfUnknownUnitsIsTheSameForDimImages) {
    for (float brightness = 10; brightness > 1e-6f; brightness *= 0.9f)
        EXPECT_EQ(exposure_of_unknown_units(Plane(kSize, kSize, brightness)),
                  of_constant(brightness));
    EXPECT_EQ(exposure_of_unknown_units(Plane(kSize, kSize, 0)), 1);
}

TEST(DisplayExposure, OfUnknownUnitsHasNoBounds) {
    float before = 1;
    for (float brightness = 15; brightness < 1e37f; brightness *= 1.1f) {
        const float factor = exposure_of_unknown_units(Plane(kSize, kSize, brightness));
        EXPECT_EQ(std::exp2(std::round(std::log2(factor))), factor);
        EXPECT_LE(factor, before);
        EXPECT_GE(factor, before / 4);
        EXPECT_GT(factor * brightness, 0.2f * 0.999f) << brightness;
        if (brightness > 640) EXPECT_LE(factor * brightness, 0.4f * 1.001f) << brightness;
        before = factor;
    }
    Plane dim(kSize, kSize, 1e-30f);
    dim(20, 30) = 1e33f;
    const float factor = exposure_of_unknown_units(dim);
    EXPECT_GT(factor * 1e-30f, 0.2f * 0.999f);
    EXPECT_LE(factor * 1e-30f, 0.4f * 1.001f);
    EXPECT_EQ(exposure_of_unknown_units(Plane(kSize, kSize, 1e-44f)), 0x1p127f);
}

TEST(DisplayExposure, LeavesOutWhatIsNoNumber) {
    Plane image(kSize, kSize, 1e-3f);
    for (int x = 0; x < kSize; ++x) {
        image(x, x) = std::numeric_limits<float>::infinity();
        image(x, kSize - 1 - x) = std::numeric_limits<float>::quiet_NaN();
    }
    EXPECT_EQ(display_exposure(image), of_constant(1e-3f));
}

}  // namespace
}  // namespace covtrace
