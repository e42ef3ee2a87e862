/// Places where media scatter light of a lamp beside the ray.
#include "shading/medium.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

namespace covtrace {
namespace {

TEST(Medium, LightOfALampBesideARayHasABoundedWeight) {
    // Light falls off as 1 / r^2, and a path through (t, r(t)) brings weight / r^2. Distances by
    // extinction alone have a weight of about 1 there, and would bring 1 / away^2 = 10000.
    const Medium medium{Rgb(0.02f), Rgb(0.08f), {}, 0};
    constexpr float length = 10;
    const LightBeside lamp{4, 0.01f, 1};
    const auto fall_off = [&](double t) {
        return 1 / (double(lamp.away) * lamp.away + (t - lamp.along) * (t - lamp.along));
    };
    constexpr int kSteps = 512;
    double sum = 0, most = 0;
    for (int i = 0; i < kSteps; ++i)
        for (int j = 0; j < kSteps; ++j) {
            const Vec2 u{(float(i) + 0.5f) / kSteps, (float(j) + 0.5f) / kSteps};
            const MediumEvent e = sample_event(medium, {}, length, Rgb(1), u, lamp);
            if (!e.scatters) continue;
            const double brought = double(e.weight.r) * fall_off(e.distance);
            sum += brought / (kSteps * kSteps);
            most = std::max(most, brought);
        }
    EXPECT_LT(most, 200);
    // The mean is the integral over the way
    double integral = 0;
    constexpr int kPieces = 200000;
    for (int i = 0; i < kPieces; ++i) {
        const double t = length * (i + 0.5) / kPieces;
        integral += 0.08 * std::exp(-0.1 * t) * fall_off(t) * length / kPieces;
    }
    EXPECT_NEAR(sum, integral, 0.005 * integral);
}

TEST(Medium, ALampFarAwayInTheRaysDirectionKeepsTheWay) {
    // From these lamps the way is seen under an angle of 1e-6 and less: the places are even on it,
    // and their weights nearly the same.
    const Medium medium{{}, Rgb(0.1f), {}, 0};
    for (const float along : {-1000.0f, 2000.0f, -30000.0f, 1e6f}) {
        constexpr int kSteps = 1000;
        double scattered = 0, places = 0;
        for (int i = 0; i < kSteps; ++i)
            for (int j = 0; j < kSteps; ++j) {
                const Vec2 u{(float(i) + 0.5f) / kSteps, (float(j) + 0.5f) / kSteps};
                const MediumEvent e =
                    sample_event(medium, {}, 1, Rgb(1), u, LightBeside{along, 0.5f, 1});
                if (!e.scatters) continue;
                scattered += double(e.weight.r) / (kSteps * kSteps);
                places += double(e.weight.r * e.distance) / (kSteps * kSteps);
            }
        const double all = 1 - std::exp(-0.1), mean = (all - 0.1 * std::exp(-0.1)) / 0.1;
        EXPECT_NEAR(scattered, all, 0.005 * all) << along;
        EXPECT_NEAR(places, mean, 0.01 * mean) << along;
    }
}

TEST(Medium, ALampThatIsNotSampledChangesNothing) {
    const Medium medium{{0.1f, 0.2f, 0}, {0.4f, 0.1f, 0.3f}, {}, 0};
    for (float u = 0.05f; u < 1; u += 0.1f) {
        const MediumEvent alone = sample_event(medium, {}, 3, {1, 0.5f, 0.2f}, {u, 1 - u}),
                          beside = sample_event(medium, {}, 3, {1, 0.5f, 0.2f}, {u, 1 - u},
                                                LightBeside{1, 0.1f, 0});
        EXPECT_EQ(alone.scatters, beside.scatters);
        EXPECT_EQ(alone.distance, beside.distance);
        EXPECT_EQ(alone.weight, beside.weight);
    }
}

TEST(Medium, GlowOfAColouredMediumHasABoundedWeight) {
    // Behind a column of 10 nothing of red is left and most of green: places by their mean would
    // see green light from there rarely, 40000 times as bright
    const DensityGrid cube(Transform(), {{0, 0, 0}, {1, 1, 10}},
                           {{0, 0, 0}, {1, 1, 10}, [](const LatticePlace&) { return 1.0f; }});
    const Glow glow{std::make_shared<const DensityGrid>(cube), {Rgb(0), Rgb{1, 2, 3}}};
    const Medium even{{3, 0.03f, 0.3f}, {0, 0, 0.1f}, {1, 2, 3}, 0, &cube};
    Medium varied = even;
    varied.glow = &glow;
    const MediumWay way(even, {0.5f, 0.5f, -1}, {0, 0, 1});
    const Rgb expected = emitted_along(even, way, 20, 0);
    constexpr int kSteps = 4000;
    std::array<double, 3> sum{}, most{};
    for (int i = 0; i < kSteps; ++i) {
        const Rgb light = emitted_along(varied, way, 20, (float(i) + 0.5f) / kSteps);
        for (int c = 0; c < 3; ++c) {
            sum[size_t(c)] += double(light[c]) / kSteps;
            most[size_t(c)] = std::max(most[size_t(c)], double(light[c]));
        }
    }
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(sum[size_t(c)], expected[c], 2e-3 * double(expected[c])) << c;
        EXPECT_LT(most[size_t(c)], 3 * double(expected[c])) << c;
    }
}

}  // namespace
}  // namespace covtrace
