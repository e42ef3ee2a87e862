// The sampler: stratification of every prefix that is a power of two, independence from order, use
// of all dimensions.
#include "core/sampler.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>
#include <vector>

namespace covtrace {
namespace {

/// Asserts that every elementary interval of area 1/n holds exactly one of n = 2^k points of a
/// (0,2)-sequence in base 2.
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
    // The squared error is that of the mean of x y over 64 points: random sampling has var(x y)/64
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
    // The mean of 20 000 numbers of different seeds is within 4 standard errors (false alarm 6e-5).
    double sum = 0;
    constexpr int n = 20000;
    for (int i = 0; i < n; ++i) {
        Sampler s(uint64_t(i), i % 37, i % 11, 5);
        sum += s.next_1d();
    }
    EXPECT_NEAR(sum / n, 0.5, 4 / std::sqrt(12.0 * n));
}

/// The mean squared error, over 100 tiles, of the mean of `f` over the first `samples` samples of
/// blocks of `width` by `width` pixels, relative to its value if the pixels had nothing to do with
/// each other: the error of single pixels over their number.
template <typename F>
double error_of_blocks(int width, uint32_t samples, double truth, F f) {
    double blocks = 0, pixels = 0;
    for (int tile = 0; tile < 100; ++tile)
        for (int y = 0; y < 16; y += width)
            for (int x = 0; x < 16; x += width) {
                double block = 0;
                for (int i = 0; i < width * width; ++i) {
                    double pixel = 0;
                    for (uint32_t k = 0; k < samples; ++k)
                        pixel += f(Sampler(5, 16 * tile + x + i % width, y + i / width, k));
                    const double error = pixel / samples - truth;
                    pixels += error * error;
                    block += error;
                }
                blocks += block * block;
            }
    return blocks / pixels;
}

// Ratio that 1 may become by chance: of at least 1600 blocks, whose squared means vary by twice
// themselves, 4 standard errors (false alarm 6e-5 each).
constexpr double kByChance = 1.14;

TEST(Sampler, NeighboursFillEachOthersGaps) {
    const auto lens = [](Sampler s) {
        const Vec2 u = s.camera().lens;
        return u.x + u.y < 0.7f ? 1.0 : 0.0;
    };
    const auto time = [](Sampler s) { return s.camera().time < 0.3f ? 1.0 : 0.0; };
    const auto later = [](Sampler s) {
        const Vec2 u = s.pair(6);
        return double(u.x) * u.y;
    };
    for (const uint32_t samples : {1u, 2u, 4u, 8u, 16u}) {
        EXPECT_LT(error_of_blocks(4, samples, 0.245, lens), 0.6) << samples;
        EXPECT_LT(error_of_blocks(4, samples, 0.3, time), 0.1) << samples;
        EXPECT_LT(error_of_blocks(4, samples, 0.25, later), 0.1) << samples;
        // These patterns have their hole at 2x2 pixels of 4 samples: no patterns are good at
        // everything.
        EXPECT_LT(error_of_blocks(2, samples, 0.25, later), samples == 4 ? kByChance : 0.5)
            << samples;
    }
}

TEST(Sampler, NumbersOfDifferentKeysDoNotGoTogetherInATile) {
    const auto both = [](Sampler s) {
        return s.pair(2).x < 0.5f && s.pair(3).x < 0.5f && s.pair(4).y < 0.5f ? 1.0 : 0.0;
    };
    const auto with_lens = [](Sampler s) {
        return s.camera().lens.x < 0.5f && s.pair(0).x < 0.5f && s.pair(1).y < 0.5f ? 1.0 : 0.0;
    };
    for (const uint32_t samples : {1u, 2u, 3u, 8u}) {
        // Two samples lie on opposite sides in every pair: where one has all three the other has
        // none, in a pixel and in its neighbours.
        const double most = samples == 2 || samples == 3 ? 1.5 : kByChance;
        EXPECT_LT(error_of_blocks(4, samples, 0.125, both), most) << samples;
        EXPECT_LT(error_of_blocks(4, samples, 0.125, with_lens), most) << samples;
    }
}

TEST(Sampler, EveryPixelOfATileIsUniform) {
    // The means over seeds of each pixel's first number are within 4.7 standard errors (false alarm
    // of all 1280 comparisons 3e-3).
    constexpr int kSeeds = 2000;
    for (int pixel = 0; pixel < 256; ++pixel) {
        std::array<double, 5> sums{};
        for (int seed = 0; seed < kSeeds; ++seed) {
            Sampler s(uint64_t(seed), 32 + pixel % 16, 48 + pixel / 16, 0);
            const auto c = s.camera();
            const Vec2 u = s.pair(4);
            const std::array<float, 5> numbers{c.film.x, c.lens.y, c.time, u.x, u.y};
            for (size_t i = 0; i < 5; ++i) sums[i] += numbers[i];
        }
        for (const double sum : sums)
            EXPECT_NEAR(sum / kSeeds, 0.5, 4.7 / std::sqrt(12.0 * kSeeds)) << pixel;
    }
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
