// Sums over pixels that are alike, in windows with strides, against sums pixel by pixel.
#include "reconstruction/window_sums.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/parallel.h"
#include "core/vec.h"

namespace covtrace {
namespace {

constexpr int kWidth = 53, kHeight = 38;  // no multiples of the strides
constexpr LikenessSettings kSettings{.sigma = 3, .any = 0};

Plane ramp(float x_slope, float y_slope) {
    Plane p(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            p(x, y) = std::sin(x_slope * float(x) + y_slope * float(y));
    return p;
}

WindowSums sums(int stride) {
    const std::vector<Plane> guides{ramp(0.3f, 0.1f)}, linear{ramp(0.9f, 0.2f), ramp(0, 1)},
        squares{ramp(0.5f, 0.7f)};
    return window_sums(guides, linear, squares, stride, kSettings);
}

TEST(WindowSums, AreThoseOfEveryPixelAStrideAway) {
    for (const int stride : {1, 4, 16, 60}) {
        const Plane guide = ramp(0.3f, 0.1f), linear = ramp(0.9f, 0.2f), square = ramp(0.5f, 0.7f);
        const WindowSums found = sums(stride);
        for (int y = 0; y < kHeight; y += 3)
            for (int x = 0; x < kWidth; x += 3) {
                double expected = 0, expected_square = 0;
                for (int dy = -Likeness::kReach; dy <= Likeness::kReach; ++dy)
                    for (int dx = -Likeness::kReach; dx <= Likeness::kReach; ++dx) {
                        const int u = x + dx * stride, v = y + dy * stride;
                        if (u < 0 || v < 0 || u >= kWidth || v >= kHeight) continue;
                        const double w =
                            std::exp(-0.5 * double(sqr(guide(u, v) - guide(x, y))) -
                                     0.5 * (dx * dx + dy * dy) / double(sqr(kSettings.sigma)));
                        expected += w * double(linear(u, v));
                        expected_square += w * w * double(square(u, v));
                    }
                ASSERT_NEAR(found.linear[0](x, y), expected, 2e-3)
                    << stride << " " << x << " " << y;
                ASSERT_NEAR(found.squares[0](x, y), expected_square, 2e-3)
                    << stride << " " << x << " " << y;
            }
    }
}

TEST(WindowSums, AreTheSameForAnyNumberOfThreads) {
    for (const int stride : {1, 4}) {
        const WindowSums all = sums(stride);
        const ThreadLimit one(1);
        const WindowSums alone = sums(stride);
        for (size_t k = 0; k < all.linear.size(); ++k)
            EXPECT_EQ(all.linear[k].values, alone.linear[k].values) << stride;
    }
}

}  // namespace
}  // namespace covtrace
