/// Mixing raw pixels into filtered ones: where the filter is wrong and where the samples are noisy.
#include "reconstruction/unfiltered_share.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace covtrace {
namespace {

constexpr int kWidth = 64, kHeight = 48;

/// A flat image of luminance 1 with noise of deviation `noise`, and its means by 1/`mean_of` of the
/// variance, off by `bias`.
struct Flat {
    RawLuminance raw;
    FilteredLuminance filtered;
    std::vector<float> own;

    Flat(float noise, float mean_of, float bias, uint32_t seed) {
        const Plane none(kWidth, kHeight);
        raw = {none, none, std::vector<bool>(none.size(), true)};
        // A Gaussian mean has 1 / (4 pi s^2) of the variance, and its own pixel 1 / (2 pi s^2).
        own.assign(none.size(), 2 / mean_of);
        filtered = {none, none, own};
        std::mt19937 random(seed);
        std::normal_distribution<float> normal;
        for (size_t i = 0; i < none.size(); ++i) {
            raw.value[i] = 1 + noise * normal(random);
            raw.variance[i] = noise * noise;
            filtered.value[i] = 1 + bias;
            filtered.variance[i] = noise * noise / mean_of;
        }
    }
    double mean_share() const {
        double sum = 0;
        const Plane share = unfiltered_share(raw, filtered);
        for (const float s : share.values) sum += s;
        return sum / double(share.size());
    }
};

TEST(UnfilteredShare, IsAllWhereTheFilterIsWrongAndNothingIsNoisy) {
    EXPECT_NEAR(Flat(1e-4f, 50, 0.2f, 1).mean_share(), 1, 1e-3);
    EXPECT_NEAR(Flat(1e-4f, 50, -0.2f, 2).mean_share(), 1, 1e-3);
}

/// About 50 pixels tell each bias: chance alone gives a share of sqrt(2 / 50) / sqrt(2 pi) = 0.08,
/// 0.64 % of the noise's variance.
TEST(UnfilteredShare, IsLittleWhereTheFilterIsRightAndPixelsAreNoisy) {
    EXPECT_LT(Flat(0.5f, 50, 0, 3).mean_share(), 0.1);
    EXPECT_LT(Flat(0.05f, 50, 0, 4).mean_share(), 0.1);
}

/// The share is near the best one, b^2 / (b^2 + r). The limits of outliers cut the tails of the
/// noise, too; 0.07 of share cost 0.6 % of r + b^2.
TEST(UnfilteredShare, WeighsBiasAgainstNoise) {
    for (const float bias : {0.05f, 0.1f, 0.2f})
        EXPECT_NEAR(Flat(0.1f, 200, bias, 5).mean_share(), bias * bias / (bias * bias + 0.01f),
                    0.07)
            << bias;
}

TEST(UnfilteredShare, IsNothingWhereBothImagesAreTheSame) {
    EXPECT_EQ(Flat(0, 50, 0, 6).mean_share(), 0);
}

TEST(UnfilteredShare, DoesNotSpreadLightBeyondSquares) {
    Flat flat(0.1f, 50, 0, 7);
    flat.raw.value[100] = 1e30f;
    flat.raw.variance[100] = INFINITY;
    const Plane share = unfiltered_share(flat.raw, flat.filtered);
    for (const float s : share.values) EXPECT_TRUE(s >= 0 && s <= 1) << s;
    EXPECT_LT(flat.mean_share(), 0.1);
}

/// A pixel of one sample looks as if it had no noise, and must not be kept for that.
TEST(UnfilteredShare, IsNothingWherePixelsDoNotKnowTheirNoise) {
    Flat flat(0.5f, 50, 0, 8);
    flat.raw.variance = Plane(kWidth, kHeight);
    flat.filtered.variance = Plane(kWidth, kHeight);
    EXPECT_GT(flat.mean_share(), 0.9);
    flat.raw.known.assign(flat.raw.known.size(), false);
    EXPECT_EQ(flat.mean_share(), 0);
}

}  // namespace
}  // namespace covtrace
