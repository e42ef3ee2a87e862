/// The choice of lights where BSDFs find some of them as well.
#include <gtest/gtest.h>

#include "light_fixtures.h"

namespace covtrace {
namespace {

using namespace test;

constexpr Vec3 kUp{0, 0, 1};

/// A scene of an even sky of radiance 1, and a small lamp straight above the origin whose
/// irradiance there is `irradiance`.
struct SkyAndLamp {
    LightScene scene;
    int lamp = 0, sky = 1;

    explicit SkyAndLamp(float irradiance) {
        scene.add_light(
            PointLight{.intensity = Rgb(9 * irradiance), .power = {}, .from = {0, 0, 3}});
        scene.add_light(InfiniteLight{});
        scene.build();
    }
    float probability(int light, Vec3 n) const {
        return scene.lights->selection_probability({}, n, light);
    }
};

TEST(LightChoice, AnEvenSkyIsLeftToBsdfsWhereALampOutshinesIt) {
    const SkyAndLamp bright(1.1f * kPi);
    EXPECT_EQ(bright.probability(bright.sky, kUp), 0);
    EXPECT_EQ(bright.probability(bright.lamp, kUp), 1);
    EXPECT_EQ(bright.scene.lights->environment_pdf({}, kUp, kUp), 0);
    // The sky still shines.
    EXPECT_EQ(bright.scene.lights->sky({}, kUp, kUp).radiance, Rgb(1));
}

TEST(LightChoice, AnEvenSkyIsDrawnForAsFarAsItOutshinesTheRest) {
    for (const float part : {0.2f, 0.5f, 0.8f}) {
        const SkyAndLamp dim(part * kPi);
        EXPECT_NEAR(dim.probability(dim.sky, kUp), (1 - part) / (1 + part), 1e-4f) << part;
        EXPECT_NEAR(dim.probability(dim.lamp, kUp), 2 * part / (1 + part), 1e-4f) << part;
    }
    // The sky is never drawn so often that the lamp is forgotten; but always where the lamp can't
    // shine.
    const SkyAndLamp faint(1e-4f);
    EXPECT_NEAR(faint.probability(faint.lamp, kUp), 0.1f, 1e-5f);
    EXPECT_EQ(faint.probability(faint.sky, -kUp), 1);
}

TEST(LightChoice, TheSunIsChosenBesideAnEvenSky) {
    LightScene scene;
    scene.add_light(DistantLight{.radiance = Rgb(20), .direction = kUp});
    scene.add_light(InfiniteLight{});
    scene.build();
    EXPECT_EQ(scene.lights->selection_probability({}, kUp, 0), 1);
    EXPECT_EQ(scene.lights->selection_probability({}, kUp, 1), 0);
}

TEST(LightChoice, ASkyAloneIsDrawnFor) {
    LightScene scene;
    scene.add_light(InfiniteLight{});
    scene.build();
    EXPECT_EQ(scene.lights->selection_probability({}, kUp, 0), 1);
    EXPECT_NEAR(scene.lights->environment_pdf({}, kUp, kUp), 1 / kPi, 1e-6f);
}

}  // namespace
}  // namespace covtrace
