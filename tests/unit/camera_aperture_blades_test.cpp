/// Apertures of blades: their points lie evenly in the polygon.
#include "camera/aperture_blades.h"

#include <gtest/gtest.h>

#include <cmath>

#include "camera/camera.h"

namespace covtrace::test {
namespace {

constexpr int kSide = 400;  // points along either side of the square

template <typename Use>
void for_points(const ApertureBlades& blades, Use use) {
    for (int i = 0; i < kSide; ++i)
        for (int j = 0; j < kSide; ++j)
            use(aperture_point(blades, {(float(i) + 0.5f) / kSide, (float(j) + 0.5f) / kSide}));
}

TEST(ApertureBlades, PointsLieInThePolygonAndReachItsCorners) {
    for (const int count : {3, 5, 6, 16}) {
        const ApertureBlades blades{count, 0.3f, 1};
        const float half = kPi / float(count);
        float farthest = 0;
        for_points(blades, [&](Vec2 p) {
            // Every edge lies at cos(pi / n) from the middle.
            for (int k = 0; k < count; ++k) {
                const float turn = 0.3f + float(2 * k) * half;
                EXPECT_LE(p.x * std::cos(turn) + p.y * std::sin(turn), std::cos(half) + 1e-5f);
            }
            farthest = std::max(farthest, length(p));
        });
        EXPECT_NEAR(farthest, 1, 0.02f) << count;
    }
}

TEST(ApertureBlades, AllPartsOfThePolygonAreAlike) {
    // A square, upright without rotation: its quarters and its middle hold what their areas are.
    const ApertureBlades blades{4, 0, 1};
    const float edge = std::sqrt(0.5f);
    int middle = 0, corner = 0;
    for_points(blades, [&](Vec2 p) {
        middle += std::abs(p.x) < edge / 2 && std::abs(p.y) < edge / 2;
        corner += p.x > edge / 2 && p.y > edge / 2;
    });
    EXPECT_NEAR(float(middle) / (kSide * kSide), 1.0f / 4, 0.005f);
    EXPECT_NEAR(float(corner) / (kSide * kSide), 1.0f / 16, 0.005f);
}

TEST(ApertureBlades, TheLikeDiscHasTheirVariance) {
    for (const ApertureBlades& blades :
         {ApertureBlades{}, ApertureBlades{3, 0, 1}, ApertureBlades{5, 1, 1},
          ApertureBlades{0, 0, 2}, ApertureBlades{6, 0.2f, 0.5f}}) {
        double sum = 0, across = 0, upward = 0;
        for_points(blades, [&](Vec2 p) {
            sum += double(p.x * p.x + p.y * p.y);
            across = std::max(across, std::abs(double(p.x)));
            upward = std::max(upward, std::abs(double(p.y)));
        });
        const double of_disc = sqr(radius_of_like_disc(blades)) / 2.0;
        EXPECT_NEAR(sum / (kSide * kSide), of_disc, 0.01 * of_disc) << blades.count;
        if (blades.count == 0) {
            EXPECT_NEAR(upward / across, double(blades.ratio), 0.01 * double(blades.ratio));
        }
    }
}

TEST(ApertureBlades, RaysOfALensLeaveFromThem) {
    CameraDescription d;
    d.lens_radius = 0.5f;
    d.blades = {3, kPi / 2, 1};  // an edge above, a corner below
    const Camera camera(d, 16, 16);
    float lowest = 0, highest = 0;
    for (int i = 0; i < 64; ++i)
        for (int j = 0; j < 64; ++j) {
            const Vec2 lens{(float(i) + 0.5f) / 64, (float(j) + 0.5f) / 64};
            const Ray ray = camera.generate_ray({8, 8}, lens, 0);
            lowest = std::min(lowest, ray.origin.y);
            highest = std::max(highest, ray.origin.y);
        }
    EXPECT_NEAR(lowest, -0.5f, 0.02f);
    EXPECT_NEAR(highest, 0.25f, 0.01f);
}

}  // namespace
}  // namespace covtrace::test
