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
    // Nothing more to give: every pixel is full.
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

RC_GTEST_PROP(AllocateUnmet, MeetsTheBudgetAndLevelsWhatIsMissing, ()) {
    const auto n = *rc::gen::inRange<size_t>(1, 200);
    std::vector<float> density(n);
    std::vector<uint32_t> have(n);
    int64_t taken = 0;
    double sum = 0;
    for (size_t i = 0; i < n; ++i) {
        sum += density[i] = float(*rc::gen::inRange(0, 1000)) * 0.01f + 0.01f;
        taken += have[i] = uint32_t(*rc::gen::inRange(0, 20));
    }
    for (float& d : density) d *= float(double(n) / sum);
    const int64_t budget = taken + *rc::gen::inRange<int64_t>(0, 3000);
    const auto counts = allocate_unmet(density, budget, have, 1u << 20);
    RC_ASSERT(total(counts) == budget);
    // Nobody who was given anything lacks less than somebody who was not, but for roundings.
    const auto lack = [&](size_t i) {
        return double(budget) / double(n) * double(density[i]) - double(counts[i]);
    };
    double least_given = 1e30, most_left = -1e30;
    for (size_t i = 0; i < n; ++i) {
        RC_ASSERT(counts[i] >= have[i]);
        most_left = std::max(most_left, lack(i));
        if (counts[i] > have[i]) least_given = std::min(least_given, lack(i));
    }
    RC_ASSERT(least_given >= most_left - 3);
}

TEST(AllocateUnmet, SamplesOnlyWhereMostIsMissing) {
    const std::vector<float> density{0.1f, 0.4f, 3.5f};
    const std::vector<uint32_t> capped{4, 4, 4};
    // 1, 4 and 35 are asked for: only the last lacks anything.
    EXPECT_EQ(allocate_unmet(density, 30, capped, 1000), (std::vector<uint32_t>{4, 4, 22}));
    // But no more than a round may give it, and then the others have their turn.
    EXPECT_EQ(allocate_unmet(density, 30, capped, 10), (std::vector<uint32_t>{7, 9, 14}));
}

TEST(RelativeDensity, HasMeanOneAndAnEvenShare) {
    Prediction p{2,
                 2,
                 {{1e-4f, 0, 1e-4f}, {0.1f, 0, 0.1f}, {0, 0, 0}, {0.02f, 0.01f, 0.03f}},
                 {1, 1, 50, 2}};
    for (DensityRule rule : {DensityRule::tempered, DensityRule::thesis}) {
        const auto g = relative_density(p, rule, 2, {0.4f, 15});
        EXPECT_NEAR(std::accumulate(g.begin(), g.end(), 0.0f) / 4, 1, 1e-5f);
        EXPECT_GT(g[1], g[0]);
        if (rule == DensityRule::tempered) {
            EXPECT_GE(*std::min_element(g.begin(), g.end()), 0.1f);
        }
    }
}

TEST(CovarianceBuffer, SmoothingFillsDarkPixelsFromTheNearestLitOnes) {
    CovarianceBuffer b(9, 1);
    b.weight[0] = 2;
    b.covariance[0](0, 0) = 4;
    const CovarianceBuffer s = smooth(b);
    for (int x = 0; x < 9; ++x) EXPECT_FLOAT_EQ(s.covariance[size_t(x)](0, 0), 4) << x;
    EXPECT_EQ(s.weight[8], 0);
    const CovarianceBuffer dark(3, 3);
    EXPECT_EQ(smooth(dark).covariance[4](0, 0), 0);
}

TEST(CovarianceBuffer, MergingWeighsThePartsByRadiance) {
    CovarianceBuffers b(2, 1);
    const auto diagonal = [](double x) {
        return covariance::SymmetricMatrix5<double>::diagonal(x, 0, 0, 0, 0);
    };
    // Squares of what 16 bits hold exactly.
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
    EXPECT_FLOAT_EQ(smooth(b).covariance[1](1, 1), 5);
}

}  // namespace
}  // namespace covtrace
