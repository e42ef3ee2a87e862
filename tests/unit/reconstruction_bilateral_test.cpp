// Bilateral means are as defined, up to the border of the image.
#include "reconstruction/bilateral.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "core/rng.h"

using namespace covtrace;

namespace {

constexpr int kWidth = 23, kHeight = 17;
constexpr float kSigma = 2, kReach = 0.6f;

Plane noise(uint64_t seed) {
    Plane plane(kWidth, kHeight);
    Rng rng(seed);
    for (float& v : plane.values) v = rng.next_float();
    return plane;
}

}  // namespace

TEST(BilateralBlur, IsTheWeightedMeanOfItsDefinition) {
    const Plane guide = noise(1), first = noise(2), second = noise(3);
    Plane weight = noise(4);
    for (float& w : weight.values) w = w < 0.3f ? 0 : w;
    Plane a = first, b = second;
    bilateral_blur(std::array{&a, &b}, weight, guide, kSigma, kReach);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            double sum_a = 0, sum_b = 0, total = 0;
            for (int v = 0; v < kHeight; ++v)
                for (int u = 0; u < kWidth; ++u) {
                    if (std::abs(u - x) > 4 || std::abs(v - y) > 4) continue;
                    const double far = double((u - x) * (u - x) + (v - y) * (v - y)) / 8,
                                 other = double(guide(u, v) - guide(x, y)) / double(kReach),
                                 k = std::exp(-far) *
                                     std::pow(std::max(0.0, 1 - other * other), 2) *
                                     double(weight(u, v));
                    sum_a += k * double(first(u, v));
                    sum_b += k * double(second(u, v));
                    total += k;
                }
            ASSERT_NEAR(a(x, y), sum_a / total, 1e-5) << x << " " << y;
            ASSERT_NEAR(b(x, y), sum_b / total, 1e-5) << x << " " << y;
        }
}

TEST(BilateralBlur, KnowsNothingWhereNothingHasWeight) {
    Plane plane = noise(5);
    bilateral_blur(std::array{&plane}, Plane(kWidth, kHeight), noise(6), kSigma, kReach);
    for (float v : plane.values) ASSERT_EQ(v, 0);
}
