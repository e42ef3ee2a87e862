// The gather: constants stay, means are kept, ellipses have the asked-for covariance, holes are
// filled.
#include "reconstruction/gather.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "covariance/gather.hpp"

namespace covtrace {
namespace {

using covariance::Sym2;

FilterField uniform_field(int w, int h, Sym2<float> s) {
    return {w, h, std::vector<Sym2<float>>(size_t(w) * size_t(h), s)};
}

FilteredImage run(const std::vector<Rgb>& mean, const FilterField& field,
                  std::vector<uint32_t> count = {}) {
    if (count.empty()) count.assign(mean.size(), 1);
    const std::vector<float> variance(mean.size(), 1.0f);
    return gather(mean, variance, count, field);
}

/// Second moments of the filter about the middle of the image, read off the response to a point.
Sym2<double> response_moments(Sym2<float> s, int size) {
    const int c = size / 2;
    std::vector<Rgb> impulse(size_t(size) * size_t(size));
    impulse[size_t(c) * size_t(size) + size_t(c)] = Rgb(1);
    const auto image = run(impulse, uniform_field(size, size, s)).color;
    double sum = 0;
    Sym2<double> m;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const double v = image[size_t(y) * size_t(size) + size_t(x)].r;
            sum += v;
            m.xx += v * (x - c) * (x - c);
            m.xy += v * (x - c) * (y - c);
            m.yy += v * (y - c) * (y - c);
        }
    return (1 / sum) * m;
}

TEST(Gather, ConstantImagesStayConstant) {
    for (float s : {0.2f, 1.0f, 30.0f, 225.0f}) {
        const auto image =
            run(std::vector<Rgb>(57 * 43, Rgb(0.7f)), uniform_field(57, 43, {s, 0.3f * s, s}))
                .color;
        for (const Rgb& c : image) ASSERT_NEAR(c.g, 0.7f, 1e-5f);
    }
}

TEST(Gather, FeaturesAreGatheredByTheWeightsOfTheLight) {
    const int w = 40, h = 30;
    const size_t n = size_t(w) * size_t(h);
    std::mt19937 rng(11);
    std::uniform_real_distribution<float> uniform;
    FilterField field = uniform_field(w, h, {2, 0.5f, 3});
    std::vector<uint32_t> count(n, 1);
    std::vector<Rgb> light(n), feature(n);
    std::array<Plane, kGatheredFeatures> planes;
    planes.fill(Plane(w, h));
    for (size_t i = 0; i < n; ++i) {
        field.covariance[i] = (0.2f + 30 * uniform(rng)) * field.covariance[i];
        if (uniform(rng) < 0.3f) count[i] = 0;
        light[i] = Rgb(uniform(rng), uniform(rng), uniform(rng));
        feature[i] = Rgb(uniform(rng), -uniform(rng), 10 * uniform(rng));
        for (size_t c = 0; c < 3; ++c) planes[4 + c][i] = feature[i][int(c)];
        planes[0][i] = light[i].g;
    }
    const std::vector<float> variance(n, 1.0f);
    const FilteredImage alone = gather(light, variance, count, field),
                        of_feature = gather(feature, variance, count, field),
                        beside = gather(light, variance, count, field,
                                        std::span<Plane, kGatheredFeatures>(planes));
    for (size_t i = 0; i < n; ++i) {
        EXPECT_EQ(beside.variance[i], alone.variance[i]);
        EXPECT_EQ(beside.own_weight[i], alone.own_weight[i]);
        EXPECT_NEAR(planes[0][i], alone.color[i].g, 1e-6f);
        EXPECT_EQ(planes[1][i], 0);
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(beside.color[i][c], alone.color[i][c], 1e-6f);
            EXPECT_NEAR(planes[size_t(4 + c)][i], of_feature.color[i][c], 1e-5f);
        }
    }
}

TEST(Gather, EllipsesHaveTheirCovariance) {
    // The cut at three deviations takes 2.7 % (2-D: chi-square with 9) off the variance; the
    // pyramid adds a little.
    for (const Sym2<float>& s : {Sym2<float>{4, 0, 4}, Sym2<float>{9, 5, 6}, Sym2<float>{1, 0, 60},
                                 Sym2<float>{100, 0, 100}, Sym2<float>{150, 60, 80}}) {
        const auto m = response_moments(s, 141);
        EXPECT_NEAR(m.xx / s.xx, 1, 0.08) << s.xx;
        EXPECT_NEAR(m.yy / s.yy, 1, 0.08) << s.yy;
        EXPECT_NEAR(m.xy, s.xy, 0.08 * std::sqrt(s.xx * s.yy));
    }
}

TEST(Gather, PixelsWithoutSamplesTakeNoPart) {
    std::vector<Rgb> mean(25 * 25, Rgb(1));
    std::vector<uint32_t> count(mean.size(), 1);
    for (size_t i = 0; i < mean.size(); i += 2) {
        mean[i] = Rgb(100);
        count[i] = 0;
    }
    for (const Rgb& c : run(mean, uniform_field(25, 25, {0.16f, 0, 0.16f}), count).color)
        EXPECT_NEAR(c.r, 1, 1e-5f);
}

TEST(Gather, AnEmptyNeighbourhoodIsFilledFromFarther) {
    std::vector<Rgb> mean(40 * 40);
    std::vector<uint32_t> count(mean.size(), 0);
    mean[0] = Rgb(3);
    count[0] = 1;
    EXPECT_NEAR(run(mean, uniform_field(40, 40, {0.16f, 0, 0.16f}), count).color.back().r, 3,
                1e-4f);
}

TEST(Gather, NonFiniteMeansAreLeftOut) {
    std::vector<Rgb> mean(9, Rgb(2));
    mean[4] = Rgb(NAN, 1, 1);
    for (const Rgb& c : run(mean, uniform_field(3, 3, {1, 0, 1})).color) EXPECT_FLOAT_EQ(c.r, 2);
}

TEST(Gather, HalvesAreGatheredAsIfAlone) {
    constexpr int kSize = 24;
    std::mt19937 random(1);
    std::uniform_real_distribution<float> value(0, 1);
    Halves halves{HalfBuffer(kSize, kSize), HalfBuffer(kSize, kSize)};
    for (size_t k = 0; k < 2; ++k) {
        for (Plane& channel : halves[k].color)
            for (float& v : channel.values) v = value(random);
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x) {
                // Each half lacks another corner, more of it than its filters reach.
                const int u = k == 0 ? x : kSize - 1 - x;
                halves[k].count(x, y) = u + y < 12 ? 0.0f : 2.0f;
            }
    }
    const FilterField field = uniform_field(kSize, kSize, {1, 0.3f, 0.5f});
    const std::array<ColorPlanes, 2> both = gather(halves, field);
    for (size_t k = 0; k < 2; ++k) {
        std::vector<Rgb> mean;
        std::vector<uint32_t> count;
        for (size_t i = 0; i < halves[k].count.size(); ++i) {
            const ColorPlanes& c = halves[k].color;
            mean.emplace_back(c[0][i], c[1][i], c[2][i]);
            count.push_back(uint32_t(halves[k].count[i]));
        }
        const auto alone = run(mean, field, count).color;
        for (size_t i = 0; i < alone.size(); ++i)
            for (size_t c = 0; c < 3; ++c)
                ASSERT_NEAR(both[k][c][i], alone[i][int(c)], 1e-5) << "half " << k << " at " << i;
    }
}

TEST(Gather, VarianceFallsByTheEffectiveNumberOfPixels) {
    // A Gaussian of deviation s averages 4 pi s^2 pixels.
    const auto g = run(std::vector<Rgb>(101 * 101, Rgb(1)), uniform_field(101, 101, {9, 0, 9}));
    EXPECT_NEAR(g.variance[50 * 101 + 50] * 4 * 3.14159f * 9, 1, 0.05f);
}

TEST(Gather, AgreesWithTheLibrarysWhereFiltersAreNarrow) {
    constexpr int kSize = 24;
    std::mt19937 random(7);
    std::uniform_real_distribution<float> value(0, 1);
    std::vector<Rgb> mean;
    std::vector<covariance::Vec3<float>> same;
    std::vector<uint32_t> count;
    for (int i = 0; i < kSize * kSize; ++i) {
        same.emplace_back(value(random), value(random), value(random));
        mean.emplace_back(same.back().x, same.back().y, same.back().z);
        count.push_back(i % 7 == 0 ? 0 : 3);
    }
    FilterField field = uniform_field(kSize, kSize, {1, 0.3f, 0.5f});
    field.covariance[100] = {3, -1, 2};
    const auto ours = run(mean, field, count).color;
    const auto plain = covariance::gather(same, count, field);
    for (size_t i = 0; i < ours.size(); ++i) {
        ASSERT_NEAR(ours[i].r, plain[i].x, 1e-4f) << i;
        ASSERT_NEAR(ours[i].b, plain[i].z, 1e-4f) << i;
    }
}

TEST(Gather, KeepsTheTotalAndSpreadsIt) {
    std::vector<Rgb> mean(61 * 61, Rgb(0));
    mean[30 * 61 + 30] = Rgb(1);
    const auto g = run(mean, uniform_field(61, 61, {4, 0, 9}));
    double sum = 0;
    for (const Rgb& c : g.color) sum += c.r;
    EXPECT_NEAR(sum, 1, 1e-3);
    EXPECT_NEAR(g.color[30 * 61 + 30].r, 1 / (2 * 3.14159f * 2 * 3), 5e-4f);
    // The two pixels are a deviation off, each.
    EXPECT_NEAR(g.color[33 * 61 + 30].r / g.color[30 * 61 + 32].r, 1, 1e-3f);
}

TEST(FilterField, SettingsFollowTheCount) {
    EXPECT_FLOAT_EQ(covariance::filter_settings(16).c, 2);
    EXPECT_FLOAT_EQ(covariance::filter_settings(16).slope, 0.25f);
    EXPECT_FLOAT_EQ(covariance::filter_settings(1024).slope, 0.125f);
    EXPECT_GT(covariance::filter_settings(256).c, 3);
    EXPECT_LT(covariance::filter_settings(256).limits.s_min, 0.35f);
}

TEST(FilterField, NeighboursLimitTheWidth) {
    FilterField f = uniform_field(21, 1, {100, 0, 25});
    f.covariance[0] = {0.25f, 0, 0.25f};
    FilterSettings settings = covariance::filter_settings(16);
    settings.limits.s_min = 0.2f;  // narrow enough not to act here
    limit_by_neighbours(f, settings);
    for (int x = 0; x < 21; ++x) {
        const float size = covariance::filter_size(f.covariance[size_t(x)]);
        EXPECT_NEAR(size, std::min(std::sqrt(std::sqrt(2500.0f)), 0.5f + 0.25f * float(x)), 2e-2f)
            << x;
    }
    // The shape stays: the long axis is still twice the short one where no clamp acts.
    EXPECT_NEAR(f.covariance[20].xx / f.covariance[20].yy, 4, 1e-3f);
}

TEST(FilterField, FiltersOfOtherLightLimitToo) {
    FilterField f{21, 1, std::vector<Sym2<float>>(21, {25, 0, 25})};
    std::vector<float> others(21, std::numeric_limits<float>::infinity());
    others[4] = 0.5f;
    const FilterSettings settings = covariance::filter_settings(16);
    limit_by_neighbours(f, settings, others);
    for (int x = 0; x < 21; ++x)
        EXPECT_NEAR(covariance::filter_size(f.covariance[size_t(x)]),
                    0.5f + 0.25f * float(std::abs(x - 4)), 1e-3f)
            << x;
}

TEST(FilterField, ThinFiltersAreAsShortAsTheirNeighboursAllow) {
    // The filters lie along a straight border; the lamp at its end is narrow in both directions.
    FilterField f = uniform_field(41, 1, {225, 0, 0.01f});
    f.covariance[0] = {0.01f, 0, 0.01f};
    const FilterSettings settings = covariance::filter_settings(16);
    FilterField sizes_only = f;
    limit_by_neighbours(sizes_only, settings);
    EXPECT_GT(sizes_only.covariance[20].xx, 100);
    limit_lengths_by_neighbours(f, settings);
    for (int x = 0; x < 41; ++x) {
        EXPECT_NEAR(std::sqrt(f.covariance[size_t(x)].xx),
                    std::min(15.0f, 0.1f + settings.slope * float(x)), 1e-3f)
            << x;
        EXPECT_NEAR(f.covariance[size_t(x)].yy, 0.01f, 1e-5f) << x;
    }
}

TEST(FilterField, UnknownLightKeepsToItsSideOfABorder) {
    // The filters are those of a bright floor, thin towards its horizon at x = 20; beyond it no
    // path met surfaces.
    FilterField f = uniform_field(41, 1, {0.25f, 0, 100});
    std::vector<bool> known(41, true);
    for (size_t x = 21; x < 41; ++x) {
        f.covariance[x] = {100, 0, 4};
        known[x] = false;
    }
    const FilterSettings settings = covariance::filter_settings(16);
    make_round_where_unknown(f, known, settings);
    for (int x = 0; x < 41; ++x) {
        const Sym2<float> filter = f.covariance[size_t(x)];
        if (x > 20) {
            EXPECT_NEAR(std::sqrt(filter.xx),
                        std::min(std::sqrt(20.0f), 0.5f + settings.slope * float(x - 20)), 1e-3f)
                << x;
            EXPECT_EQ(filter.xx, filter.yy) << x;
            EXPECT_EQ(filter.xy, 0) << x;
        } else {
            EXPECT_EQ(filter.xx, 0.25f) << x;
            EXPECT_EQ(filter.yy, 100) << x;
        }
    }
}

/// Damaged films have such spectra.
TEST(FilterField, SpectraBeyondFloatsGiveTheNarrowestFilter) {
    constexpr float kMost = std::numeric_limits<float>::max(),
                    kInf = std::numeric_limits<float>::infinity(),
                    kNan = std::numeric_limits<float>::quiet_NaN();
    const std::vector<Sym2<float>> spectrum{
        {kMost, 0, 1}, {kInf, 0, kInf}, {kInf, kInf, kInf}, {kNan, 0, 1}, {1, kNan, 1}};
    const FilterSettings settings = covariance::filter_settings(16);
    for (const FilterRule rule :
         {FilterRule::verified, FilterRule::predicted, FilterRule::matched, FilterRule::thesis})
        for (const auto& filter : filter_field(spectrum, 5, 1, rule, settings).covariance) {
            EXPECT_NEAR(filter.xx, settings.limits.s_min * settings.limits.s_min, 1e-6f);
            EXPECT_TRUE(std::isfinite(filter.xy) && std::isfinite(filter.yy));
        }
}

/// The rule is the same whatever the count of samples is.
TEST(FilterField, MatchedRuleHasTheSignalsOwnCovariance) {
    const std::vector<Sym2<float>> spectrum{{0.01f, 0.002f, 0.02f}};
    for (const double samples : {1.0, 16.0, 1024.0}) {
        const FilterField field =
            filter_field(spectrum, 1, 1, FilterRule::matched, covariance::filter_settings(samples));
        // A Gaussian exp(-p^T F^-1 p / 2) has a spectrum of the covariance (4 pi^2 F)^-1.
        const auto own = covariance::inverse(covariance::four_pi_sq<float> * field.covariance[0]);
        EXPECT_NEAR(own.xx, spectrum[0].xx, 1e-6f) << samples;
        EXPECT_NEAR(own.xy, spectrum[0].xy, 1e-6f) << samples;
        EXPECT_NEAR(own.yy, spectrum[0].yy, 1e-6f) << samples;
    }
}

TEST(FilterField, ThesisRuleIsWiderByItsConstant) {
    const std::vector<Sym2<float>> spectrum{{0.01f, 0, 0.01f}};
    const FilterSettings settings = covariance::filter_settings(16);
    const auto verified = filter_field(spectrum, 1, 1, FilterRule::verified, settings);
    const auto thesis = filter_field(spectrum, 1, 1, FilterRule::thesis, settings);
    // The ratio is 4 pi^2 c^2 against 2 pi, with c = 2.
    EXPECT_NEAR(thesis.covariance[0].xx / verified.covariance[0].xx, 2 * 3.14159265f * 4, 1e-2f);
}

}  // namespace
}  // namespace covtrace
