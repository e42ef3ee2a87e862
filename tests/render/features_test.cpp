// Features that denoisers and regressions are told of a pixel: those of objects in mirrors and
// behind glass.
#include <gtest/gtest.h>

#include "tests/render/fixtures.h"

namespace covtrace {
namespace {

using namespace test;

/// Renders a wall of `material` that is tilted by 45 degrees, with the camera looking along +z; it
/// shows, two units further on along +x, a card of the reflectance 0.8, 0.4, 0.1, or the sky where
/// there is none.
Image tilted_wall(const std::string& material, bool card = true) {
    const std::string text =
        R"(
Integrator "path" "integer maxdepth" 5
Film "rgb" "integer xresolution" 8 "integer yresolution" 8
LookAt 0 0 -4  0 0 0  0 1 0
Camera "perspective" "float fov" 10
WorldBegin
LightSource "infinite" "rgb L" [ 1 1 1 ]
Material )" +
        material + R"(
Shape "trianglemesh" "point3 P" [ -1 -1 -1  1 -1 1  1 1 1  -1 1 -1 ] "integer indices" [ 0 1 2 0 2 3 ]
Material "diffuse" "rgb reflectance" [ 0.8 0.4 0.1 ]
)" +
        (card
             ? R"(Shape "trianglemesh" "point3 P" [ 2 -2 -2  2 -2 2  2 2 2  2 2 -2 ] "integer indices" [ 0 1 2 0 2 3 ])"
             : "");
    RenderOptions options = uniform(64, 1);
    options.features = true;
    return render_text(text, options).image;
}

/// The mean of a channel over the image.
double mean(const Image& image, const std::string& channel) {
    double sum = 0;
    for (float v : image.find(channel)->values) sum += double(v);
    return sum / double(image.pixel_count());
}

constexpr const char* kMirror =
    R"("conductor" "rgb reflectance" [ 0.9 0.9 0.9 ] "float roughness" 0)";

TEST(Features, SumsHaveTheAlbedoOfBothParts) {
    const Image image = tilted_wall(R"("diffuse"
MakeNamedMaterial "a" "string type" "diffuse" "rgb reflectance" [ 0.4 0.4 0.4 ]
MakeNamedMaterial "b" "string type" "diffuse" "rgb reflectance" [ 0.2 0.2 0.2 ]
Material "mix" "string materials" [ "a" "b" ] "float weight" 2)");
    EXPECT_NEAR(middle_mean(image, "albedo.G"), 0.6, 0.02);
    EXPECT_NEAR(middle_mean(image, "featurealbedo.G"), 0.6, 0.02);
}

TEST(Features, AMirrorShowsTheCardThatItReflects) {
    const Image image = tilted_wall(kMirror);
    const double mirror = mean(image, "albedo.R");
    EXPECT_GT(mirror, 0.85);
    EXPECT_NEAR(mean(image, "albedo.B"), mirror, 0.02);
    EXPECT_NEAR(mean(image, "Z"), 4, 0.05);
    EXPECT_NEAR(mean(image, "featurealbedo.R"), 0.8 * mirror, 0.01);
    EXPECT_NEAR(mean(image, "featurealbedo.G"), 0.4 * mirror, 0.01);
    EXPECT_NEAR(mean(image, "featurealbedo.B"), 0.1 * mirror, 0.01);
    EXPECT_NEAR(mean(image, "featureN.X"), -1, 1e-4);
    EXPECT_NEAR(mean(image, "featureN.Z"), 0, 1e-4);
}

TEST(Features, AMirrorThatShowsTheSkyTellsOfItself) {
    const Image image = tilted_wall(kMirror, false);
    EXPECT_EQ(mean(image, "featurealbedo.R"), mean(image, "albedo.R"));
    EXPECT_EQ(mean(image, "featureN.Z"), mean(image, "N.Z"));
}

TEST(Features, ARoughMetalTellsOfItself) {
    const Image image =
        tilted_wall(R"("conductor" "rgb reflectance" [ 0.9 0.9 0.9 ] "float roughness" 0.3)");
    EXPECT_EQ(mean(image, "featurealbedo.B"), mean(image, "albedo.B"));
    EXPECT_EQ(mean(image, "featureN.X"), mean(image, "N.X"));
}

TEST(Features, ACoatShowsAsMuchAsItReflects) {
    // The base is black, so that all of the feature's colour is the card's, in the coat.
    const Image image =
        tilted_wall(R"("coateddiffuse" "rgb reflectance" [ 0 0 0 ] "float roughness" 0)");
    // Fresnel's equations for unpolarised light at 45 degrees on an index of 1.5: 5.0 %. The share
    // of the samples that the coat reflects is drawn evenly.
    EXPECT_NEAR(mean(image, "featurealbedo.R"), 0.050 * 0.8, 0.004);
    EXPECT_NEAR(mean(image, "featurealbedo.B"), 0.050 * 0.1, 0.001);
}

TEST(Features, AreNotKeptUnasked) {
    const Image image = render_text(R"(
Film "rgb" "integer xresolution" 4 "integer yresolution" 4
Camera "perspective"
WorldBegin
LightSource "infinite"
)",
                                    uniform(1))
                            .image;
    EXPECT_EQ(image.find("featurealbedo.R"), nullptr);
}

}  // namespace
}  // namespace covtrace
