// Emitters in view are filtered apart from the light that they shed on surfaces.
#include <gtest/gtest.h>

#include "tests/render/fixtures.h"

namespace covtrace {
namespace {

using namespace test;

/// The scene: a wall lit by a weak lamp at the camera, and before it a square that is 10^4 times
/// brighter and faces the camera. `lens`: parameters of the camera.
std::string lamp_before_wall(const std::string& lens) {
    return R"(
Integrator "path" "integer maxdepth" 1
Film "rgb" "integer xresolution" 32 "integer yresolution" 32
PixelFilter "box" "float xradius" 0.5 "float yradius" 0.5
LookAt 0 0 -4  0 0 0  0 1 0
Camera "perspective" "float fov" 40 )" +
           lens + R"(
WorldBegin
LightSource "point" "point3 from" [ 0 0 -4 ] "rgb I" [ 1 1 1 ]
Material "diffuse" "rgb reflectance" [ 0.5 0.5 0.5 ]
Shape "trianglemesh" "point3 P" [ -9 -9 1  9 -9 1  9 9 1  -9 9 1 ] "integer indices" [ 0 2 1 0 3 2 ]
AreaLightSource "diffuse" "rgb L" [ 60 60 60 ]
Shape "trianglemesh" "point3 P" [ -.5 -.5 0  .5 -.5 0  .5 .5 0  -.5 .5 0 ] "integer indices" [ 0 2 1 0 3 2 ]
)";
}

TEST(InView, NothingLeaksOverTheBorderOfALampInFocus) {
    const Image image = render_text(lamp_before_wall(""), covariance_method(16, 1)).image;
    const auto& lamp = image.find("inview.R")->values;
    int beside = 0;
    for (size_t i = 0; i < lamp.size(); ++i) {
        if (lamp[i] > 0) continue;
        ++beside;
        // The bound is 0.5 % of the lamp; the narrowest filter of scattered light would carry 10 %
        // of it here.
        EXPECT_LT(image.rgb(i).r, 0.3f) << "pixel " << i;
    }
    EXPECT_GT(beside, 700);
    EXPECT_LT(beside, 1000);
}

TEST(InView, ALampOutOfFocusIsSmoothedAndKeepsItsLight) {
    const std::string scene = lamp_before_wall(R"("float lensradius" 0.4 "float focaldistance" 2)");
    const Image image = render_text(scene, covariance_method(16, 1)).image;
    const Image reference = render_text(scene, uniform(512, 2)).image;
    double light = 0, reference_light = 0, error = 0, raw_error = 0;
    for (size_t i = 0; i < image.pixel_count(); ++i) {
        const float r = reference.rgb(i).r;
        light += image.rgb(i).r;
        reference_light += r;
        error += sqr(image.rgb(i).r - r);
        raw_error += sqr(image.rgb(i, "raw.").r - r);
    }
    EXPECT_NEAR(light / reference_light, 1, 0.02);
    EXPECT_LT(error, 0.7 * raw_error);
}

TEST(InView, BothPartsMakeUpTheCovarianceOfAllLight) {
    RenderOptions options = covariance_method(4, 3);
    options.cov_spp = 4;
    const Image image = render_text(lamp_before_wall(""), options).image;
    const auto value = [&](const char* name, size_t i) { return image.find(name)->values[i]; };
    for (size_t i = 0; i < image.pixel_count(); ++i) {
        if (value("inview.R", i) > 0) {
            EXPECT_GE(value("covweight.Y", i), value("scatteredcovweight.Y", i));
            continue;
        }
        EXPECT_EQ(value("covweight.Y", i), value("scatteredcovweight.Y", i));
        EXPECT_FLOAT_EQ(value("cov.00", i), value("scatteredcov.00", i));
        EXPECT_FLOAT_EQ(value("cov.11", i), value("scatteredcov.11", i));
    }
}

}  // namespace
}  // namespace covtrace
