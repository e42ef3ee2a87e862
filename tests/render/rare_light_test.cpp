// Rare light: `--error` does not trust samples that cannot have met it.
#include <gtest/gtest.h>

#include "tests/render/fixtures.h"

namespace covtrace {
namespace {

using namespace test;

/// The scene: a lamp covers some 10^-4 of a pixel and, seen at once, adds as much light to it as
/// there is already. The lamp hangs before the camera, or behind it over a mirror.
std::string scene(bool lamp, bool mirror) {
    return std::string(R"(
Film "rgb" "integer xresolution" 16 "integer yresolution" 16
LookAt 0 0 -8  0 0 0  0 1 0
Camera "perspective" "float fov" 40
WorldBegin
LightSource "infinite" "rgb L" [ 0.5 0.5 0.5 ]
)") +
           (mirror ? R"(Material "conductor" "float roughness" 0
Shape "trianglemesh" "point3 P" [ -9 -9 0  9 -9 0  9 9 0  -9 9 0 ] "integer indices" [ 0 2 1 0 3 2 ]
)"
                   : "") +
           (lamp ? std::string(R"(AreaLightSource "diffuse" "rgb L" [ 5000 5000 5000 ]
Translate 0.3 0.2 )") + (mirror ? "-9" : "0") +
                       R"(
Shape "sphere" "float radius" )" +
                       (mirror ? "0.005" : "0.002") + R"(
)"
                 : "");
}

/// Samples per pixel with which a render ends that asks for an error of 5 %.
double enough(const std::string& text) {
    RenderOptions options;
    options.method = Method::hybrid;
    options.error = 0.05;
    options.seed = 1;
    const Image image = render_text(text, options).image;
    double sum = 0;
    for (float v : image.find("samples.Y")->values) sum += double(v);
    return sum / double(image.pixel_count());
}

TEST(RareLight, WhatIsEvenEndsWithTheLeastNumberOfSamples) {
    EXPECT_EQ(enough(scene(false, false)), 16);
    EXPECT_EQ(enough(scene(false, true)), 16);
}

/// A lamp in one pixel of 256 is an error of about 1 in squares over I^2 there, which alone is 6 %.
TEST(RareLight, ALampThatNoSampleHasMetCounts) {
    EXPECT_GT(enough(scene(true, false)), 1000);
}

TEST(RareLight, SoDoesItsImageInAMirror) {
    EXPECT_GT(enough(scene(true, true)), 1000);
}

TEST(RareLight, LampsBesideTheCircleOfAFisheyeDoNotCount) {
    const auto fisheye = [](const std::string& lamp) {
        return R"(
Film "rgb" "integer xresolution" 16 "integer yresolution" 16
PixelFilter "box"
Camera "spherical" "string mapping" "equidistant" "float fov" 40
WorldBegin
LightSource "infinite" "rgb L" [ 0.5 0.5 0.5 ]
)" + lamp + R"(
Translate 2.82 2.82 8
Shape "sphere" "float radius" 0.002
)";
    };
    // In a corner of the film, 26 degrees from the axis: as if it did not shine
    EXPECT_EQ(enough(fisheye(R"(AreaLightSource "diffuse" "rgb L" [ 5000 5000 5000 ])")),
              enough(fisheye("")));
}

}  // namespace
}  // namespace covtrace
