// Light that stays in its pixels: of one thing, and of the brightest pixels of an image.
#include "reconstruction/light_in_place.h"

#include <gtest/gtest.h>

#include "reconstruction_images.h"

namespace covtrace {
namespace {

using namespace test;

ColorPlanes black(int size) {
    ColorPlanes planes;
    planes.fill(Plane(size, size));
    return planes;
}

TEST(LightInPlace, AThingKeepsWhatIsTooBrightForItsSurroundings) {
    ColorPlanes e = black(kSize), color = black(kSize);
    for (Plane& p : e) {
        for (float& v : p.values) v = 0.1f;
        p(9, 9) = 100;
    }
    const Plane around(kSize, kSize, 1000);
    keep_in_place(around, e, color);
    // 65 may be given to others, of which the 48 pixels around it have 4.8
    EXPECT_NEAR(color[1](9, 9), 100 - 60.2f, 0.1f);
    EXPECT_EQ(color[1](10, 9), 0);
    EXPECT_EQ(color[1](30, 30), 0);
}

TEST(LightInPlace, TheBrightestPixelsKeepSoMuchInAll) {
    ColorPlanes e = black(kSize), color = black(kSize);
    for (Plane& p : e) {
        p(1, 1) = 50;
        p(2, 5) = 30;
        p(3, 3) = 10;
        p(4, 4) = -80;
    }
    keep_brightest(e, 40, color);
    EXPECT_NEAR(color[0](1, 1), 30, 1e-4f);
    EXPECT_NEAR(color[0](2, 5), 10, 1e-4f);
    EXPECT_EQ(color[0](3, 3), 0);
    EXPECT_EQ(color[0](4, 4), 0);
    // More than there is: all of it
    color = black(kSize);
    keep_brightest(e, 500, color);
    EXPECT_EQ(color[0](1, 1), 50);
    EXPECT_EQ(color[0](3, 3), 10);
    EXPECT_EQ(color[0](4, 4), 0);
}

}  // namespace
}  // namespace covtrace
