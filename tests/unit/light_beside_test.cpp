/// The choice of a finite light for a piece of a ray.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "light_fixtures.h"

namespace covtrace {
namespace {

using namespace test;

PointLight lamp(float intensity, Vec3 from) {
    return {.intensity = Rgb(intensity), .power = {}, .from = from};
}

TEST(LightBeside, LightsAreChosenByWhatTheyBringToTheRay) {
    // Over a ray from -infinity to infinity, 1 / r^2 has the integral pi / D: of lamps of
    // intensities 1, 2 and 4 at the distances 1, 1 and 8 that is as 2 : 4 : 1.
    LightScene scene;
    const std::array<Vec3, 3> places{Vec3{1, 0, 0}, Vec3{0, 1, 3}, Vec3{0, -8, 0}};
    const std::array<float, 3> intensities{1, 2, 4};
    for (size_t i = 0; i < places.size(); ++i) scene.add_light(lamp(intensities[i], places[i]));
    scene.build();
    constexpr int kSteps = 7000;
    std::array<double, 3> share{}, place{};
    for (int i = 0; i < kSteps; ++i) {
        float u = (float(i) + 0.5f) / kSteps;
        const auto chosen = scene.lights->choose_beside({0, 0, -5000}, {0, 0, 1}, 10000, u);
        ASSERT_TRUE(chosen);
        EXPECT_EQ(chosen->share, 1);
        ASSERT_GE(u, 0);
        ASSERT_LT(u, 1);
        for (size_t k = 0; k < places.size(); ++k) {
            if (length(chosen->ball.center - places[k]) > 1e-3f) continue;
            share[k] += 1.0 / kSteps;
            place[k] += double(u) / kSteps;
        }
    }
    EXPECT_NEAR(share[0], 2.0 / 7, 2e-3);
    EXPECT_NEAR(share[1], 4.0 / 7, 2e-3);
    EXPECT_NEAR(share[2], 1.0 / 7, 2e-3);
    // The place of the number within a lamp's part is even
    for (size_t k = 0; k < places.size(); ++k) EXPECT_NEAR(place[k], share[k] / 2, 2e-3);
}

TEST(LightBeside, TheSkyTakesItsShare) {
    LightScene scene;
    scene.add_light(lamp(9, {0, 0, 3}));
    scene.add_light(DistantLight{.radiance = Rgb(1), .direction = {0, 0, 1}});
    scene.build();
    float u = 0.5f;
    const auto chosen = scene.lights->choose_beside({-1, 0, 0}, {1, 0, 0}, 2, u);
    ASSERT_TRUE(chosen);
    EXPECT_EQ(chosen->share, scene.lights->selection_probability({}, {}, 0));
    EXPECT_GT(chosen->share, 0);
    EXPECT_LT(chosen->share, 1);
}

TEST(LightBeside, ASceneOfSkyAloneHasNone) {
    LightScene scene;
    scene.add_light(InfiniteLight{});
    scene.build();
    float u = 0.25f;
    EXPECT_FALSE(scene.lights->choose_beside({}, {0, 0, 1}, 5, u));
    EXPECT_EQ(u, 0.25f);
}

}  // namespace
}  // namespace covtrace
