// Blurs keep constants everywhere and sums away from the border.
#include "core/plane.h"

#include <gtest/gtest.h>

namespace covtrace {
namespace {

TEST(Plane, BlursKeepConstants) {
    const Plane p(17, 9, 3);
    for (float v : box_blur(p, 4).values) EXPECT_NEAR(v, 3, 1e-5);
    for (float v : gaussian_blur(p, 2.5f).values) EXPECT_NEAR(v, 3, 1e-5);
}

TEST(Plane, BlursKeepTheSumOfAPoint) {
    Plane p(41, 41);
    p(20, 20) = 1;
    for (const Plane& blurred : {box_blur(p, 3), gaussian_blur(p, 3)}) {
        double sum = 0;
        for (float v : blurred.values) sum += double(v);
        EXPECT_NEAR(sum, 1, 1e-5);
    }
    EXPECT_NEAR(box_blur(p, 3)(23, 17), 1 / 49.0f, 1e-6);
    EXPECT_FLOAT_EQ(box_blur(p, 3)(24, 20), 0);
    // The kernel has two axes of deviation 3, cut at 9: 1/(2 pi 9) at the centre, but for the cut.
    EXPECT_NEAR(gaussian_blur(p, 3)(20, 20), 1 / (2 * 3.14159265f * 9), 2e-4);
}

TEST(Plane, SmallerThanTheBlur) {
    Plane p(2, 1);
    p[0] = 1;
    const Plane blurred = gaussian_blur(p, 5);
    EXPECT_GT(blurred[0], blurred[1]);
    EXPECT_NEAR(blurred[0] + blurred[1], 1, 0.02);
}

}  // namespace
}  // namespace covtrace
