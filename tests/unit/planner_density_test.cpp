// The planner: exact budgets, limits, shares.
#include "planner/density.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <numeric>

namespace covtrace {
namespace {

int64_t total(const std::vector<uint32_t>& counts) {
    return std::accumulate(counts.begin(), counts.end(), int64_t{0});
}

RC_GTEST_PROP(Allocate, MeetsTheBudgetExactly, ()) {
    const auto n = *rc::gen::inRange<size_t>(1, 400);
    std::vector<float> density(n);
    std::vector<uint32_t> least(n);
    int64_t taken = 0;
    for (size_t i = 0; i < n; ++i) {
        density[i] = float(*rc::gen::inRange(0, 1000)) * 0.01f + 0.01f;
        least[i] = uint32_t(*rc::gen::inRange(0, 4));
        taken += least[i];
    }
    const int64_t budget = taken + *rc::gen::inRange<int64_t>(0, 3000);
    const auto counts = allocate(density, budget, least, 1u << 20);
    RC_ASSERT(total(counts) == budget);
    for (size_t i = 0; i < n; ++i) RC_ASSERT(counts[i] >= least[i]);
}

TEST(Allocate, FollowsTheDensity) {
    const std::vector<float> density{1, 2, 3, 4};
    const std::vector<uint32_t> none(4, 0);
    EXPECT_EQ(allocate(density, 100, none, 1000), (std::vector<uint32_t>{10, 20, 30, 40}));
}

TEST(Allocate, StopsAtTheLimits) {
    const std::vector<float> density{1, 100};
    const std::vector<uint32_t> least{5, 0};
    EXPECT_EQ(allocate(density, 40, least, 30), (std::vector<uint32_t>{10, 30}));
    // All pixels are full: there is nothing more to give.
    EXPECT_EQ(allocate(density, 1000, least, 30), (std::vector<uint32_t>{30, 30}));
}

TEST(Allocate, SpreadsLessThanOneSamplePerPixel) {
    const std::vector<float> even(1000, 1.0f);
    const std::vector<uint32_t> none(1000, 0);
    const auto counts = allocate(even, 250, none, 100);
    EXPECT_EQ(total(counts), 250);
    for (uint32_t c : counts) EXPECT_LE(c, 1u);
    for (size_t start = 0; start < 1000; start += 100)
        EXPECT_EQ(
            std::accumulate(counts.begin() + long(start), counts.begin() + long(start) + 100, 0u),
            25u);
}

RC_GTEST_PROP(AllocateOnDemand, MeetsTheBudgetAndFillsUpToOneMultipleOfTheDensity, ()) {
    const auto n = *rc::gen::inRange<size_t>(1, 200);
    std::vector<float> density(n);
    std::vector<uint32_t> have(n);
    int64_t taken = 0;
    for (size_t i = 0; i < n; ++i) {
        density[i] = float(*rc::gen::inRange(0, 1000)) * 0.01f + 0.01f;
        taken += have[i] = uint32_t(*rc::gen::inRange(0, 20));
    }
    const int64_t budget = taken + *rc::gen::inRange<int64_t>(0, 3000);
    const auto counts = allocate_on_demand(density, budget, have, 1u << 20);
    RC_ASSERT(total(counts) == budget);
    // No pixel got anything beyond the multiple that those who got nothing have, but for roundings.
    double least_left = 1e30;
    for (size_t i = 0; i < n; ++i) {
        RC_ASSERT(counts[i] >= have[i]);
        least_left = std::min(least_left, (double(counts[i]) + 1) / double(density[i]));
    }
    for (size_t i = 0; i < n; ++i)
        if (counts[i] > have[i]) RC_ASSERT((double(counts[i]) - 2) / density[i] <= least_left);
}

TEST(AllocateOnDemand, LimitsWhatARoundAdds) {
    const std::vector<float> density{1, 4, 5};
    const std::vector<uint32_t> have{4, 4, 4};
    EXPECT_EQ(allocate_on_demand(density, 40, have, 1000), (std::vector<uint32_t>{4, 16, 20}));
    // Samples that the limit of a round leaves go to the others; the next round may add as much
    // again.
    const auto first = allocate_on_demand(density, 34, have, 10);
    EXPECT_EQ(first, (std::vector<uint32_t>{6, 14, 14}));
    EXPECT_EQ(allocate_on_demand(density, 54, first, 10), (std::vector<uint32_t>{6, 24, 24}));
}

TEST(Emphasis, IsWhatTheThesisAsksForBeyondTheTemperedDensity) {
    constexpr int kSide = 40;
    constexpr size_t kPixels = size_t(kSide) * kSide;
    const covariance::Sym2<float> spectrum{0.01f, 0, 0.0225f};
    Prediction p{kSide, kSide, std::vector(kPixels, spectrum), std::vector<float>(kPixels, 2)};
    // Lens and shutter ask for 64 times as many samples on the right as on the left.
    for (size_t i = 0; i < kPixels; ++i)
        if (i % kSide >= kSide / 2) p.interior_count[i] = 128;
    const covariance::FilterLimits<float> limits{0.4f, 15};
    const Plane thesis = emphasis(p, covariance::DensityRule::thesis, 2, limits);
    const float detail = std::sqrt(0.015f);
    EXPECT_NEAR(thesis(0, 20), std::pow(2 * detail * detail / (detail * std::sqrt(2.0f)), 0.7f),
                1e-4f);
    EXPECT_NEAR(thesis(39, 20), std::pow(128 * detail * detail / (detail * 2), 0.7f), 1e-3f);
    // The emphasis is a mean over a few pixels.
    EXPECT_NEAR(thesis(19, 20) + thesis(20, 20), thesis(0, 20) + thesis(39, 20), 1e-3f);
    EXPECT_GT(thesis(19, 20), 3 * thesis(0, 20));
    for (const float v : emphasis(p, covariance::DensityRule::tempered, 2, limits).values)
        EXPECT_EQ(v, 1);
}

TEST(RelativeDensity, HasMeanOneAndAnEvenShare) {
    Prediction p{2,
                 2,
                 {{1e-4f, 0, 1e-4f}, {0.1f, 0, 0.1f}, {0, 0, 0}, {0.02f, 0.01f, 0.03f}},
                 {1, 1, 50, 2}};
    using Rule = covariance::DensityRule;
    for (Rule rule : {Rule::tempered, Rule::thesis}) {
        const auto g = relative_density(p, rule, 2, {0.4f, 15});
        EXPECT_NEAR(std::accumulate(g.begin(), g.end(), 0.0f) / 4, 1, 1e-5f);
        EXPECT_GT(g[1], g[0]);
        if (rule == Rule::tempered) {
            EXPECT_GE(*std::min_element(g.begin(), g.end()), 0.1f);
        }
    }
}

TEST(CovarianceBuffer, SmoothingFillsDarkPixelsFromTheNearestLitOnes) {
    CovarianceBuffer b(9, 1);
    b.weight[0] = 2;
    b.covariance[0](0, 0) = 4;
    const CovarianceBuffer s = smoothed(b);
    for (int x = 0; x < 9; ++x) EXPECT_FLOAT_EQ(s.covariance[size_t(x)](0, 0), 4) << x;
    EXPECT_EQ(s.weight[8], 0);
    const CovarianceBuffer dark(3, 3);
    EXPECT_EQ(smoothed(dark).covariance[4](0, 0), 0);
}

TEST(CovarianceBuffer, MergingWeighsThePartsByRadiance) {
    CovarianceBuffers b(2, 1);
    const auto diagonal = [](double x) {
        return covariance::SymmetricMatrix5<double>::diagonal(x, 0, 0, 0, 0);
    };
    // The entries are squares of numbers that 16 bits hold exactly.
    b.scattered[0] = {diagonal(1), 1};
    b.in_view[0] = {diagonal(6.25), 3};
    b.scattered[1] = {diagonal(9), 2};
    const CovarianceBuffer all = merge(b);
    EXPECT_FLOAT_EQ(all.covariance[0](0, 0), 4.9375f);
    EXPECT_FLOAT_EQ(all.weight[0], 4);
    EXPECT_FLOAT_EQ(all.covariance[1](0, 0), 9);
    EXPECT_FLOAT_EQ(all.weight[1], 2);
}

TEST(CovarianceBuffer, SmoothingWeighsByRadiance) {
    CovarianceBuffer b(3, 1);
    b.weight = {1, 3, 0};
    b.covariance[0](1, 1) = 8;
    b.covariance[1](1, 1) = 4;
    EXPECT_FLOAT_EQ(smoothed(b).covariance[1](1, 1), 5);
}

}  // namespace
}  // namespace covtrace
