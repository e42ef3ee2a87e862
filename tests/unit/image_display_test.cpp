#include "image/display.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "image/color_encoding.h"

namespace covtrace::test {
namespace {

using Shown = std::array<uint8_t, 3>;

Shown shown(Rgb c, ViewTransform view, float exposure = 0) {
    return display_8bit(c, {exposure, view});
}

TEST(Display, SrgbIsCutAtWhite) {
    for (const float v : {-1.0f, 0.0f, 0.001f, 0.18f, 0.5f, 1.0f, 2.0f, kInfinity}) {
        const uint8_t e = srgb_encode_8bit(v);
        EXPECT_EQ(shown(Rgb(v), ViewTransform::srgb), (Shown{e, e, e})) << v;
    }
    EXPECT_EQ(shown({0.5f, std::nanf(""), 0.25f}, ViewTransform::srgb), (Shown{188, 0, 137}));
}

/// A picture of which a share is grey of this luminance, and the rest of another.
Image greys(float share, float light, float rest) {
    constexpr int kSide = 20;
    Image image{{0, 0, kSide, kSide}, {0, 0, kSide, kSide}, {}, {}};
    for (const char* name : {"R", "G", "B"}) {
        Channel& c = image.add_channel(name);
        std::fill(c.values.begin(), c.values.end(), rest);
        std::fill_n(c.values.begin(), size_t(share * kSide * kSide), light);
    }
    return image;
}

TEST(Display, StopsTooBright) {
    EXPECT_EQ(stops_too_bright(greys(1, 10, 0), {}), 5);  // 10 / 2^5 is 0.31
    EXPECT_EQ(stops_too_bright(greys(1, 8.001f, 0), {}), 5);
    EXPECT_EQ(stops_too_bright(greys(1, 7.999f, 0), {}), 4);
    EXPECT_EQ(stops_too_bright(greys(1, 10, 0), {1}), 6);
    EXPECT_EQ(stops_too_bright(greys(1, 1.99f, 0), {}), 0);
    EXPECT_EQ(stops_too_bright(greys(1, 3e38f, 0), {}), 129);
    // Half of what has light, and at least a tenth of the picture
    EXPECT_EQ(stops_too_bright(greys(0.55f, 10, 0.1f), {}), 5);
    EXPECT_EQ(stops_too_bright(greys(0.45f, 10, 0.1f), {}), 0);
    EXPECT_EQ(stops_too_bright(greys(0.45f, 10, 0), {}), 5);
    EXPECT_EQ(stops_too_bright(greys(0.05f, 10, 0), {}), 0);
    // Values that are no numbers do not count
    EXPECT_EQ(stops_too_bright(greys(0.55f, std::nanf(""), 10), {}), 5);
    EXPECT_EQ(stops_too_bright(greys(1, kInfinity, 0), {}), 0);
    EXPECT_EQ(stops_too_bright(greys(1, -10, 0), {}), 0);
    EXPECT_EQ(stops_too_bright(greys(1, 10, 0), {0, ViewTransform::agx}), 0);
    EXPECT_EQ(stops_too_bright({}, {}), 0);
}

TEST(Display, StopsAreFactorsOfTwo) {
    for (const ViewTransform view :
         {ViewTransform::srgb, ViewTransform::filmic, ViewTransform::agx}) {
        EXPECT_EQ(shown({0.1f, 0.2f, 0.05f}, view, 1.5f),
                  shown(Rgb{0.1f, 0.2f, 0.05f} * std::exp2(1.5f), view));
        EXPECT_EQ(shown({0.8f, 0.2f, 0.05f}, view, -2), shown({0.2f, 0.05f, 0.0125f}, view));
        EXPECT_NE(shown(Rgb(0.2f), view, 1), shown(Rgb(0.2f), view));
    }
}

TEST(Display, AllViewsKeepTheOrderOfGreys) {
    for (const ViewTransform view :
         {ViewTransform::srgb, ViewTransform::filmic, ViewTransform::agx}) {
        EXPECT_LE(shown(Rgb(), view)[0], 1);
        EXPECT_GE(shown(Rgb(1e30f), view)[0], 254);
        EXPECT_GE(shown(Rgb(kInfinity), view)[0], 254);
        EXPECT_LE(shown(Rgb(std::nanf("")), view)[0], 1);
        uint8_t last = 0;
        for (float v = 1e-4f; v < 100; v *= 1.1f) {
            const Shown s = shown(Rgb(v), view);
            EXPECT_GE(s[0], last) << v;
            EXPECT_NEAR(s[0], s[1], 1);
            EXPECT_NEAR(s[0], s[2], 1);
            last = s[0];
        }
    }
}

TEST(Display, FilmicIsHablesCurve) {
    // By hand: the curve of 2 is 0.357429, that of the white 11.2 is 0.725131.
    EXPECT_EQ(shown(Rgb(1), ViewTransform::filmic)[0], srgb_encode_8bit(0.357429f / 0.725131f));
    EXPECT_EQ(shown(Rgb(5.6f), ViewTransform::filmic)[0], 255);
    EXPECT_LT(shown(Rgb(5), ViewTransform::filmic)[0], 253);
}

/// The sigmoid of AgX as its author defines it (Sobotka 2022, AgX.py): through (10 / 16.5, 1 / 2)
/// with a slope of 2, limits of the power 3.
double sobotka(double x) {
    constexpr double kX = 10 / 16.5, kY = 0.5, kSlope = 2, kPower = 3;
    const bool is_toe = x < kX;
    const double px = is_toe ? kX : 1 - kX, py = is_toe ? kY : 1 - kY;
    const double rise = kSlope * px;
    const double scale =
        std::pow(std::pow(rise, -kPower) * (std::pow(rise / py, kPower) - 1), -1 / kPower);
    const double t = kSlope * std::abs(x - kX) / scale;
    const double part = scale * t / std::pow(1 + std::pow(t, kPower), 1 / kPower);
    return is_toe ? kY - part : kY + part;
}

TEST(Display, AgxIsItsAuthorsSigmoid) {
    for (double stops = -10; stops <= 6.5; stops += 0.25) {
        const auto v = float(0.18 * std::exp2(stops));
        EXPECT_NEAR(shown(Rgb(v), ViewTransform::agx)[1], 255 * sobotka((stops + 10) / 16.5), 2.1)
            << stops;
    }
    // Grey of 18 % is the middle of the display.
    EXPECT_NEAR(shown(Rgb(0.18f), ViewTransform::agx)[0], 127.5, 1.5);
}

TEST(Display, AgxLetsBrightColoursBecomeWhite) {
    const Shown dim = shown({0.18f, 0, 0}, ViewTransform::agx);
    const Shown bright = shown({18, 0, 0}, ViewTransform::agx);
    EXPECT_LT(dim[1], 40);
    EXPECT_GT(bright[1], 100);
    EXPECT_EQ(shown({18, 0, 0}, ViewTransform::srgb)[1], 0);
}

}  // namespace
}  // namespace covtrace::test
