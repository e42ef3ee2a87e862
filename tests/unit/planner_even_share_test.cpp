// The share of the samples that goes to all pixels alike.
#include "planner/even_share.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>

namespace covtrace {
namespace {

constexpr int kSize = 96;

/// An image of brightness 1 whose samples have this variance in its left half and that one in its
/// right half.
SampleKnowledge image_of(float left, float right) {
    SampleKnowledge known{
        Plane(kSize, kSize, 1), Plane(kSize, kSize, left), Plane(kSize, kSize, 1), {}, {}};
    for (int y = 0; y < kSize; ++y)
        for (int x = kSize / 2; x < kSize; ++x) known.variance(x, y) = right;
    return known;
}

float share_of(const SampleKnowledge& known, double samples) {
    const std::array halves{known, known};
    return even_share(halves, samples);
}

TEST(EvenShare, CleanImagesFollowThePlanAndNoisyOnesDoNot) {
    EXPECT_FLOAT_EQ(share_of(image_of(0, 0), 16), kLeastEvenShare);
    EXPECT_GT(share_of(image_of(1e5f, 1e5f), 16), 0.99f);
    // Noise as strong as the light: half of every pixel is noise
    EXPECT_NEAR(share_of(image_of(16 * 1.01f, 16 * 1.01f), 16), 0.15 + 0.85 / 8, 1e-3);
}

TEST(EvenShare, APlanIsKeptWhereNoiseIsInAPartOfTheImage) {
    EXPECT_LT(share_of(image_of(0, 200), 16), 0.4f);
}

TEST(EvenShare, FallsAsSamplesGrow) {
    const SampleKnowledge known = image_of(100, 100);
    EXPECT_GT(share_of(known, 4), 0.9f);
    EXPECT_LT(share_of(known, 1024), kLeastEvenShare + 0.001f);
}

// Nine of ten pixels have not met the rare paths that make the noise of all.
TEST(EvenShare, RareNoiseIsThatOfThePixelsAround) {
    SampleKnowledge rare = image_of(0, 0);
    for (size_t i = 0; i < rare.variance.size(); i += 10) rare.variance[i] = 1e4f;
    EXPECT_NEAR(share_of(rare, 16), share_of(image_of(1e3f, 1e3f), 16), 0.02);
}

TEST(EvenShare, PixelsWithoutANumberAreLeftOut) {
    SampleKnowledge known = image_of(0, 0);
    known.brightness(40, 40) = std::numeric_limits<float>::infinity();
    EXPECT_FLOAT_EQ(share_of(known, 16), kLeastEvenShare);
}

}  // namespace
}  // namespace covtrace
