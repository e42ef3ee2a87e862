// Densities follow noise over brightness, detail and cost.
#include "planner/adaptive.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

namespace covtrace {
namespace {

constexpr int kSize = 48;
constexpr float kEven = 0.3f;

/// Left half as `base`, right half as the caller changes it.
struct Case {
    Case() : spectrum(size_t(kSize) * kSize, covariance::Sym2<float>{0.01f, 0, 0.01f}) {}
    std::vector<covariance::Sym2<float>> spectrum;
    SampleKnowledge known{
        Plane(kSize, kSize, 1), Plane(kSize, kSize, 1), Plane(kSize, kSize, 4), {}, {}, false};
    /// Density at the middle of the right half over that of the left one, of what is not even.
    double ratio() {
        known.spectrum = spectrum;
        const std::vector<float> d = adaptive_density(known, kEven);
        const double mean = std::accumulate(d.begin(), d.end(), 0.0) / double(d.size());
        EXPECT_NEAR(mean, 1, 1e-4);
        const size_t row = size_t(kSize) * kSize / 2;
        return (double(d[row + 3 * kSize / 4]) - kEven) / (double(d[row + kSize / 4]) - kEven);
    }
    template <typename Body>
    void right(const Body& body) {
        for (int y = 0; y < kSize; ++y)
            for (int x = kSize / 2; x < kSize; ++x) body(size_t(y) * kSize + size_t(x));
    }
};

TEST(AdaptiveDensity, FollowsTheDeviation) {
    Case c;
    c.right([&](size_t i) { c.known.variance[i] = 9; });
    EXPECT_NEAR(c.ratio(), 3, 0.01);
}

TEST(AdaptiveDensity, FollowsTheInverseBrightness) {
    Case c;
    c.right([&](size_t i) { c.known.brightness[i] = 4; });
    EXPECT_NEAR(c.ratio(), std::sqrt(1.01 / 16.01), 0.01);
}

TEST(AdaptiveDensity, FollowsTheInverseRootOfTheCost) {
    Case c;
    c.right([&](size_t i) { c.known.cost[i] = 16; });
    EXPECT_NEAR(c.ratio(), 0.5, 0.01);
}

TEST(AdaptiveDensity, FollowsTheRootOfTheFilterSize) {
    // Twice as fine in both axes: det times 16, to the power 1/4.
    Case c;
    c.right([&](size_t i) { c.spectrum[i] = {0.04f, 0, 0.04f}; });
    EXPECT_NEAR(c.ratio(), 2, 0.01);
}

TEST(AdaptiveDensity, FollowsTheEmphasis) {
    Case c;
    c.known.emphasis = Plane(kSize, kSize, 0.5f);
    c.right([&](size_t i) { c.known.emphasis[i] = 3; });
    EXPECT_NEAR(c.ratio(), 6, 0.02);
}

TEST(AdaptiveDensity, FollowsARareBrightPathWhereItWasSeenAndOwnSamplesLess) {
    for (const bool own : {false, true}) {
        Case c;
        const size_t middle = size_t(kSize) * kSize / 2 + kSize / 2;
        c.known.variance[middle] = 1e4f;
        c.known.spectrum = c.spectrum;
        c.known.own = own;
        const std::vector<float> d = adaptive_density(c.known, kEven);
        const auto beyond_even = [&](size_t i) { return double(d[i]) - double(kEven); };
        const double far = beyond_even(0);
        // The middle of a Gaussian: of 1e4 under the root, of the root 100 itself.
        const double sigma = own ? 1.5 : 0.7, share = 1 / (2 * std::numbers::pi * sigma * sigma);
        const double expected = own ? 1 + 99 * share : std::sqrt(1 + 9999 * share);
        EXPECT_NEAR(beyond_even(middle) / far, expected, 0.05 * expected);
        EXPECT_NEAR(beyond_even(middle + 4) / far, own ? 1 + 99 * share * std::exp(-8 / 2.25) : 1,
                    0.1);
    }
}

TEST(AdaptiveDensity, NothingIsStarved) {
    Case c;
    c.right([&](size_t i) { c.known.variance[i] = 0; });
    c.known.spectrum = c.spectrum;
    for (float d : adaptive_density(c.known, kEven)) EXPECT_GE(d, 0.29f);
}

TEST(AdaptiveDensity, BlackImageIsEven) {
    Case c;
    std::fill(c.known.variance.values.begin(), c.known.variance.values.end(), 0.0f);
    c.known.spectrum = c.spectrum;
    for (float d : adaptive_density(c.known, kEven)) EXPECT_FLOAT_EQ(d, 1);
}

}  // namespace
}  // namespace covtrace
