// Pixel filters: positions follow the filter, weights have mean one, moments match the formula.
#include "camera/pixel_filter.h"

#include <gtest/gtest.h>

#include <cmath>

namespace covtrace {
namespace {

struct Moments {
    double mean_weight = 0, first = 0, second = 0;
};

Moments moments(const PixelFilter& filter) {
    Moments m;
    constexpr int n = 1600;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const auto s = filter.sample({(float(i) + 0.5f) / n, (float(j) + 0.5f) / n});
            m.mean_weight += s.weight;
            m.first += double(s.weight) * s.offset.x;
            m.second += double(s.weight) * s.offset.x * s.offset.x;
        }
    const double count = double(n) * n;
    return {m.mean_weight / count, m.first / count, m.second / count};
}

TEST(PixelFilter, BoxIsUniform) {
    const PixelFilter f({.kind = FilterDescription::Kind::box, .x_radius = 0.5f, .y_radius = 0.5f});
    const Moments m = moments(f);
    EXPECT_NEAR(m.mean_weight, 1, 1e-5);
    EXPECT_NEAR(m.second, 1.0 / 12, 1e-4);
    EXPECT_EQ(f.sample({0.25f, 0.75f}).weight, 1);
    EXPECT_NEAR(f.sample({0.25f, 0.75f}).offset.x, -0.25f, 1e-5f);
}

TEST(PixelFilter, TriangleHasItsVariance) {
    const PixelFilter f({.kind = FilterDescription::Kind::triangle, .x_radius = 2, .y_radius = 1});
    EXPECT_NEAR(moments(f).second, 4.0 / 6, 2e-3);
    EXPECT_NEAR(f.variance().y, 1.0 / 6, 1e-4);
}

TEST(PixelFilter, NegativeLobesKeepTheMean) {
    for (auto kind : {FilterDescription::Kind::mitchell, FilterDescription::Kind::lanczos_sinc}) {
        const PixelFilter f({.kind = kind, .x_radius = 2, .y_radius = 2});
        const Moments m = moments(f);
        EXPECT_NEAR(m.mean_weight, 1, 5e-3);
        EXPECT_NEAR(m.first, 0, 1e-3);
        EXPECT_NEAR(m.second, f.variance().x, 5e-3);
    }
}

TEST(PixelFilter, MitchellGoesNegativeOutside) {
    const PixelFilter f({.kind = FilterDescription::Kind::mitchell, .x_radius = 2, .y_radius = 2});
    EXPECT_LT(f.sample({0.001f, 0.5f}).weight, 0);
    EXPECT_GT(f.sample({0.5f, 0.5f}).weight, 1);
}

TEST(PixelFilter, OffsetsStayInsideTheRadius) {
    for (auto kind : {FilterDescription::Kind::box, FilterDescription::Kind::triangle,
                      FilterDescription::Kind::gaussian, FilterDescription::Kind::mitchell,
                      FilterDescription::Kind::lanczos_sinc}) {
        const PixelFilter f({.kind = kind, .x_radius = 1.5f, .y_radius = 1.5f});
        for (float u : {0.0f, 0.3f, 0x1.fffffep-1f}) {
            EXPECT_LE(std::abs(f.sample({u, u}).offset.x), 1.5f);
            EXPECT_LE(std::abs(f.sample({u, u}).offset.y), 1.5f);
        }
    }
}

TEST(PixelFilter, GaussiansKeepTheirShapeHoweverWideTheRadius) {
    using Kind = FilterDescription::Kind;
    for (const float radius : {5.0f, 5000.0f, 65536.0f}) {
        const PixelFilter f({.kind = Kind::gaussian, .x_radius = radius, .y_radius = radius});
        const Moments m = moments(f);
        EXPECT_NEAR(m.mean_weight, 1, 1e-5) << radius;
        EXPECT_NEAR(m.second, 0.25, 1e-3) << radius;
        EXPECT_NEAR(f.variance().x, 0.25f, 1e-4f) << radius;
    }
}

TEST(PixelFilter, NarrowFiltersAreNumbers) {
    using Kind = FilterDescription::Kind;
    for (const Kind kind :
         {Kind::box, Kind::triangle, Kind::gaussian, Kind::mitchell, Kind::lanczos_sinc})
        for (const float radius : {1e-3f, 1e-6f, 1e-30f, 1e-38f})
            for (const float sigma : {0.5f, 1e-30f, 1e-38f, 1e38f}) {
                const PixelFilter f(
                    {.kind = kind, .x_radius = radius, .y_radius = radius, .sigma = sigma});
                for (const float u : {0.0f, 0.3f, 0.5f, 0x1.fffffep-1f}) {
                    const auto s = f.sample({u, u});
                    EXPECT_LE(std::abs(s.offset.x), radius * 1.00001f);
                    EXPECT_TRUE(s.weight > 0.5f && s.weight < 2) << radius;
                }
            }
    // A Gaussian that is much narrower than its sigma, less its value at the radius, is a parabola.
    const PixelFilter parabola({.kind = Kind::gaussian, .x_radius = 1e-6f, .y_radius = 1e-3f});
    EXPECT_NEAR(parabola.variance().x / 1e-12, 0.2, 1e-3);
    EXPECT_NEAR(parabola.variance().y / 1e-6, 0.2, 1e-3);
}

}  // namespace
}  // namespace covtrace
