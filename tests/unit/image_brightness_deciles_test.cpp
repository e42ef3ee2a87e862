#include "image/brightness_deciles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace covtrace {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

/// Number of pixels in each decile.
std::vector<int64_t> sizes(const std::vector<uint8_t>& deciles) {
    std::vector<int64_t> result;
    for (size_t k = 0; k < kDeciles; ++k)
        result.push_back(std::count(deciles.begin(), deciles.end(), uint8_t(k)));
    return result;
}

TEST(BrightnessDeciles, SortsBlocksByTheirMean) {
    // The plane is ten blocks side by side, brighter to the left; one bright pixel does not make a
    // bright block.
    Plane plane(80, 8);
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 80; ++x) plane(x, y) = float(10 - x / 8);
    plane(79, 0) = 20;
    const std::vector<uint8_t> deciles = brightness_deciles(plane);
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 80; ++x) ASSERT_EQ(deciles[size_t(y * 80 + x)], 9 - x / 8) << x;
}

TEST(BrightnessDeciles, EqualBlocksStayInTheirOrder) {
    const std::vector<uint8_t> deciles = brightness_deciles(Plane(16, 40, 0.5f));
    for (size_t y = 0; y < 40; ++y)
        for (size_t x = 0; x < 16; ++x) ASSERT_EQ(deciles[y * 16 + x], y / 8 * 2 + x / 8);
}

TEST(BrightnessDeciles, BlocksAtTheBorderCountWithTheirPixels) {
    // The plane is 5 x 2 blocks; those at the right are one pixel wide, those at the bottom two
    // high.
    Plane plane(33, 10, 1);
    for (int y = 0; y < 8; ++y) plane(32, y) = 0.5f;
    for (int y = 8; y < 10; ++y) plane(32, y) = 2;
    EXPECT_EQ(sizes(brightness_deciles(plane)),
              (std::vector<int64_t>{8, 64, 64, 64, 64, 16, 16, 16, 16, 2}));
}

TEST(BrightnessDeciles, GroupsAreAsEqualAsTheyCanBe) {
    EXPECT_EQ(sizes(brightness_deciles(Plane(8 * 13, 8, 1))),
              (std::vector<int64_t>{64, 64, 64, 128, 64, 64, 128, 64, 64, 128}));
    // Some groups are empty, as there are fewer than ten blocks.
    EXPECT_EQ(sizes(brightness_deciles(Plane(16, 8, 1))),
              (std::vector<int64_t>{0, 0, 0, 0, 64, 0, 0, 0, 0, 64}));
    EXPECT_EQ(sizes(brightness_deciles(Plane(3, 2, 1))),
              (std::vector<int64_t>{0, 0, 0, 0, 0, 0, 0, 0, 0, 6}));
}

TEST(BrightnessDeciles, LeavesOutWhatIsNotFinite) {
    // The first of eleven blocks has no finite pixel; the second has one that is dark.
    Plane plane(88, 8, 1);
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 16; ++x) plane(x, y) = y % 2 == 0 ? kNan : kInf;
    plane(12, 3) = 0.25f;
    const std::vector<uint8_t> deciles = brightness_deciles(plane);
    EXPECT_EQ(sizes(deciles), (std::vector<int64_t>{1, 64, 64, 64, 64, 64, 64, 64, 64, 64}));
    EXPECT_EQ(deciles[3 * 88 + 12], 0);
    EXPECT_EQ(deciles[3 * 88 + 13], kNoDecile);
    EXPECT_EQ(deciles[0], kNoDecile);
    EXPECT_EQ(sizes(brightness_deciles(Plane(8, 8, kNan))), std::vector<int64_t>(kDeciles, 0));
}

}  // namespace
}  // namespace covtrace
