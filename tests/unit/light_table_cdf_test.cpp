#include "light/table_cdf.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "core/rng.h"

namespace covtrace {
namespace {

std::vector<double> cumulated(std::vector<double> weights) {
    std::partial_sum(weights.begin(), weights.end(), weights.begin());
    return weights;
}

/// Weights of very different sizes, a third of them zero.
std::vector<double> uneven(size_t count, uint64_t seed) {
    Rng rng(seed);
    std::vector<double> weights(count);
    for (double& w : weights)
        w = rng.next_float() < 1.0f / 3 ? 0 : std::exp(20 * double(rng.next_float()));
    weights[count / 2] = 1;
    return weights;
}

TEST(TableCdf, FindsWhatBisectionFinds) {
    for (const size_t count : {1, 2, 3, 7, 64, 1000}) {
        const std::vector<double> sums = cumulated(uneven(count, count));
        std::vector<float> upper;
        for (const double s : sums) upper.push_back(static_cast<float>(s / sums.back()));
        const TableCdf cdf(sums);
        Rng rng(5);
        std::vector<float> places{0, kLargestBelowOne};
        for (int i = 0; i < 20000; ++i) places.push_back(rng.next_float());
        for (const float border : upper)
            for (const float u : {border, std::nextafter(border, 0.0f)})
                if (u < 1) places.push_back(u);
        for (float u : places) {
            const auto above = std::upper_bound(upper.begin(), upper.end(), u);
            const auto expected = std::min(static_cast<size_t>(above - upper.begin()), count - 1);
            const float lo = expected > 0 ? upper[expected - 1] : 0;
            float rest = u;
            ASSERT_EQ(cdf.sample(rest), expected) << u << " of " << count;
            ASSERT_GE(rest, 0);
            ASSERT_LT(rest, 1);
            ASSERT_NEAR(lo + rest * (upper[expected] - lo), u, 1e-6);
        }
    }
}

TEST(TableCdf, KeepsRowsApart) {
    constexpr size_t kRows = 5, kEntries = 100;
    TableCdf rows(kRows, kEntries);
    for (size_t row = 0; row < kRows; ++row) rows.set_row(row, cumulated(uneven(kEntries, row)));
    Rng rng(6);
    for (size_t row = 0; row < kRows; ++row) {
        const TableCdf alone(cumulated(uneven(kEntries, row)));
        for (int i = 0; i < 1000; ++i) {
            const float u = rng.next_float();
            float a = u, b = u, c = u;
            ASSERT_EQ(rows.sample(a, row), alone.sample(b));
            ASSERT_EQ(a, b);
            ASSERT_EQ(rows.finish(rows.begin(c, row), c, row), alone.sample(b = u));
            ASSERT_EQ(a, c);
        }
    }
}

TEST(TableCdf, TreatsAllAlikeWhereNothingWeighs) {
    const TableCdf cdf(std::vector<double>(4, 0.0));
    for (size_t i = 0; i < 4; ++i) {
        float u = (static_cast<float>(i) + 0.5f) / 4;
        EXPECT_EQ(cdf.sample(u), i);
        EXPECT_NEAR(u, 0.5f, 1e-6f);
    }
}

}  // namespace
}  // namespace covtrace
