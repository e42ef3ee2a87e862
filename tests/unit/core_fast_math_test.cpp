#include "core/fast_math.h"

#include <gtest/gtest.h>

namespace covtrace {
namespace {

TEST(FastMath, SinesAndCosines) {
    constexpr int kSteps = 200000;
    for (int i = -kSteps; i <= kSteps; ++i) {
        const float x = static_cast<float>(i) * (10.0f / kSteps);
        const SinCos s = sin_cos(x);
        ASSERT_NEAR(s.sin, std::sin(double(x)), 2e-7) << x;
        ASSERT_NEAR(s.cos, std::cos(double(x)), 2e-7) << x;
    }
    for (int i = -kSteps; i <= kSteps; ++i) {
        const float x = static_cast<float>(i) * (kPi / 4 / kSteps);
        const SinCos s = sin_cos_octant(x);
        const double sine = std::sin(double(x));
        ASSERT_NEAR(s.sin, sine, 1e-7 * std::abs(sine)) << x;
        ASSERT_NEAR(s.cos, std::cos(double(x)), 1e-7) << x;
    }
}

TEST(FastMath, ArcTangentsAllAround) {
    constexpr int kSteps = 200000;
    for (int i = 0; i < kSteps; ++i) {
        const double angle = 2 * M_PI * i / kSteps;
        for (const double radius : {1e-12, 0.3, 5e9}) {
            const auto x = static_cast<float>(radius * std::cos(angle));
            const auto y = static_cast<float>(radius * std::sin(angle));
            const double expected = std::atan2(double(y), double(x));
            ASSERT_NEAR(arctangent(y, x), expected, 3e-7 * std::abs(expected)) << x << ' ' << y;
        }
    }
    EXPECT_EQ(arctangent(0, 0), 0);
    EXPECT_EQ(arctangent(0, 2), 0);
    EXPECT_FLOAT_EQ(arctangent(0, -2), kPi);
    EXPECT_FLOAT_EQ(arctangent(3, 0), kPi / 2);
    EXPECT_FLOAT_EQ(arctangent(-3, 0), -kPi / 2);
}

}  // namespace
}  // namespace covtrace
