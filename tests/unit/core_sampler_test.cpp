// The sampler: stratification of every prefix that is a power of two, independence from order, use
// of all dimensions.
#include "core/sampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

namespace covtrace {
namespace {

/// Every elementary interval of area 1/n holds exactly one of n = 2^k points of a (0,2)-sequence in
/// base 2.
void expect_elementary_intervals(const std::vector<Vec2>& points) {
    const int n = static_cast<int>(points.size());
    for (int columns = 1; columns <= n; columns *= 2) {
        const int rows = n / columns;
        std::set<int> cells;
        for (const Vec2& p : points)
            cells.insert(int(p.x * float(columns)) * rows + int(p.y * float(rows)));
        EXPECT_EQ(int(cells.size()), n) << columns << " columns";
    }
}

TEST(Sampler, PairsAreStratifiedInEveryElementaryInterval) {
    for (int pair = 0; pair < 20; ++pair) {
        std::vector<Vec2> points;
        for (uint32_t i = 0; i < 64; ++i) {
            Sampler s(7, 3, 5, i);
            s.set_dimension(pair);
            points.push_back(s.next_2d());
        }
        expect_elementary_intervals(points);
    }
}

TEST(Sampler, CameraDimensionsAreStratified) {
    std::vector<Vec2> film, lens, time;
    for (uint32_t i = 0; i < 256; ++i) {
        const auto c = Sampler(1, 10, 20, i).camera();
        film.push_back(c.film);
        lens.push_back(c.lens);
        time.push_back({c.time, 0});
    }
    expect_elementary_intervals(film);
    // Single dimensions of a Sobol sequence are (0,1)-sequences.
    for (const auto& points : {lens, time}) {
        std::set<int> cells;
        for (const Vec2& p : points) cells.insert(int(p.x * 256));
        EXPECT_EQ(cells.size(), 256u);
    }
}

TEST(Sampler, IntegratesSmoothFunctionsFasterThanRandom) {
    // Mean squared error of the mean of x y over 64 points: random sampling has var(x y)/64
    // = 7.6e-4.
    double squares = 0;
    constexpr int kRuns = 200;
    for (int run = 0; run < kRuns; ++run) {
        double sum = 0;
        for (uint32_t i = 0; i < 64; ++i) {
            Sampler s(uint64_t(run), 0, 0, i);
            s.set_dimension(3);
            const Vec2 u = s.next_2d();
            sum += double(u.x) * u.y;
        }
        const double error = sum / 64 - 0.25;
        squares += error * error;
    }
    EXPECT_LT(squares / kRuns, 7.6e-4 / 30);
}

TEST(Sampler, MeanOverSeedsIsUniform) {
    // 20 000 numbers of different seeds: the mean is within 4 standard errors (false alarm 6e-5).
    double sum = 0;
    constexpr int n = 20000;
    for (int i = 0; i < n; ++i) {
        Sampler s(uint64_t(i), i % 37, i % 11, 5);
        sum += s.next_1d();
    }
    EXPECT_NEAR(sum / n, 0.5, 4 / std::sqrt(12.0 * n));
}

TEST(Sampler, PixelsSeedsAndPairsDiffer) {
    const Vec2 a = Sampler(1, 2, 3, 4).next_2d();
    EXPECT_NE(a, Sampler(2, 2, 3, 4).next_2d());
    EXPECT_NE(a, Sampler(1, 3, 2, 4).next_2d());
    EXPECT_NE(a, Sampler(1, 2, 3, 5).next_2d());
    Sampler s(1, 2, 3, 4);
    EXPECT_EQ(a, s.next_2d());
    EXPECT_NE(a, s.next_2d());
}

TEST(Sampler, GivesPartsOfTheStreamAlone) {
    for (uint32_t i = 0; i < 1000; ++i) {
        Sampler s(7, 5, int(i % 13), i);
        EXPECT_EQ(s.film(), s.camera().film);
        s.set_dimension(9);
        const auto four = s.next_four_2d();
        for (uint32_t k = 0; k < 4; ++k) EXPECT_EQ(s.pair(9 + k), four[k]);
    }
}

TEST(Sampler, NumbersStayBelowOne) {
    for (uint32_t i = 0; i < 100000; ++i) {
        Sampler s(3, 1, 1, i);
        const auto c = s.camera();
        for (float v : {c.film.x, c.film.y, c.lens.x, c.lens.y, c.time}) {
            ASSERT_GE(v, 0);
            ASSERT_LT(v, 1);
        }
    }
}

}  // namespace
}  // namespace covtrace
