// Bodies that scatter light inside: what they send back, and that they let nothing be lost.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/render/fixtures.h"

namespace covtrace {
namespace {

using namespace test;

/// A view straight down on a wide block of a material, or on a ball of it, in a white surrounding.
std::string scene_of(const std::string& material, const std::string& shape, int max_depth = 30) {
    return fmt::format(R"(
Integrator "path" "integer maxdepth" {}
Film "rgb" "integer xresolution" 16 "integer yresolution" 16
PixelFilter "box"
LookAt 0 0 4  0 0 0  0 1 0
Camera "orthographic" "float screenwindow" [ -.3 .3 -.3 .3 ]
WorldBegin
LightSource "infinite" "rgb L" [ 1 1 1 ]
AttributeBegin
Scale .05 .05 .05
Texture "wrinkles" "float" "wrinkled" "float roughness" .6
AttributeEnd
Texture "bumps" "float" "scale" "texture tex" "wrinkles" "float scale" .02
Material "subsurface" {}
{}
)",
                       max_depth, material, shape);
}

const std::string kBlock =
    "Translate 0 0 -1\nScale 40 40 1\n"
    "Shape \"trianglemesh\" \"point3 P\" [ -1 -1 -1  1 -1 -1  1 1 -1  -1 1 -1  -1 -1 1  1 -1 1  1 "
    "1 "
    "1  -1 1 1 ] \"integer indices\" [ 0 2 1 0 3 2 4 5 6 4 6 7 0 1 5 0 5 4 1 2 6 1 6 5 2 3 7 2 7 6 "
    "3 "
    "0 4 3 4 7 ]";

struct Means {
    Rgb mean, error;
};
Means means_of(const std::string& text, double samples) {
    const Image image = render_text(text, uniform(samples)).image;
    Means m;
    const auto n = float(image.pixel_count());
    for (size_t i = 0; i < image.pixel_count(); ++i) {
        m.mean += image.rgb(i) / n;
        m.error += image.rgb(i, "variance.") / (n * n);
    }
    for (int c = 0; c < 3; ++c) m.error[c] = std::sqrt(m.error[c]);
    return m;
}

// False alarm: 6e-7 for each of the channels.
void expect_means(const std::string& text, Rgb expected, float model, double samples = 256) {
    const Means m = means_of(text, samples);
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(m.mean[c], expected[c], 5 * m.error[c] + model) << text << " channel " << c;
}

// The fit of the reflectance is good to 0.005.
TEST(Subsurface, WideBodiesHaveTheirReflectance) {
    expect_means(scene_of("\"rgb reflectance\" [ .8 .5 .2 ] \"rgb mfp\" [ .02 .01 .02 ] \"bool "
                          "refracts\" false \"float eta\" 1",
                          kBlock),
                 {0.8f, 0.5f, 0.2f}, 0.005f);
    // Light that enters along the view comes from deeper, and less of it comes back. A border of
    // index 1 reflects nothing.
    expect_means(scene_of("\"rgb reflectance\" [ .8 .5 .2 ] \"rgb mfp\" [ .02 .01 .02 ] \"float "
                          "eta\" 1",
                          kBlock),
                 {0.8f, 0.5f, 0.2f}, 0.012f);
}

// The border reflects 2 % of the surrounding towards the viewer, and inside more than half.
TEST(Subsurface, BordersOfAnIndexKeepTheReflectance) {
    const float f = 0.0201f;
    expect_means(scene_of("\"rgb reflectance\" [ .8 .5 .2 ] \"rgb mfp\" [ .01 .01 .01 ] \"float "
                          "eta\" 1.33",
                          kBlock),
                 {f + 0.8f * (1 - f), f + 0.5f * (1 - f), f + 0.2f * (1 - f)}, 0.02f);
}

TEST(Subsurface, ForwardScatteringKeepsTheReflectance) {
    expect_means(scene_of("\"rgb reflectance\" [ .8 .5 .2 ] \"rgb mfp\" [ .01 .01 .01 ] \"bool "
                          "refracts\" false \"float eta\" 1 \"float g\" .7",
                          kBlock),
                 {0.8f, 0.5f, 0.2f}, 0.02f);
}

// A furnace: nothing absorbs, so all light that arrives leaves again, from any border.
TEST(Subsurface, WhiteBallsSendBackAllLight) {
    for (const char* border :
         {"\"float eta\" 1", "\"float eta\" 1.5", "\"float eta\" 1.5 \"float roughness\" .3",
          "\"bool refracts\" false \"float eta\" 1.5 \"float roughness\" .3 "
          "\"float refractedshare\" .5"})
        for (const char* body :
             {"\"rgb reflectance\" [ 1 1 1 ] \"rgb mfp\" [ .1 .3 1 ]",
              "\"rgb sigma_a\" [ 0 0 0 ] \"rgb sigma_s\" [ 5 2 .1 ] \"float g\" .5"})
            expect_means(
                scene_of(std::string(body) + border, "Shape \"sphere\" \"float radius\" .5", 1000),
                Rgb(1), 2e-3f, 64);
}

// Light enters by and leaves through normals that are turned, also where below the one is above the
// other.
TEST(Subsurface, TurnedNormalsLoseNoLight) {
    for (const char* border :
         {"\"float eta\" 1", "\"float eta\" 1.5", "\"bool refracts\" false \"float eta\" 1"})
        expect_means(scene_of(std::string("\"rgb reflectance\" [ 1 1 1 ] \"rgb mfp\" [ .1 .1 .1 ] "
                                          "\"texture displacement\" \"bumps\" ") +
                                  border,
                              "Shape \"sphere\" \"float radius\" .5", 1000),
                     Rgb(1), 5e-3f, 64);
}

// Walks in steps that positions don't resolve would not find back to the surface.
TEST(Subsurface, DensestBodiesHaveTheirReflectance) {
    for (const char* path : {"0", "1e-30", "1e-9", "1e-6"})
        expect_means(
            scene_of(fmt::format("\"rgb reflectance\" [ .8 .5 .2 ] \"rgb mfp\" [ {0} .02 {0} ] "
                                 "\"bool refracts\" false \"float eta\" 1",
                                 path),
                     kBlock),
            {0.8f, 0.5f, 0.2f}, 0.007f);
}

// A mesh's other parts end the body, and what is inside of it does not.
TEST(Subsurface, WalksPassThingsInside) {
    const std::string white = "\"rgb reflectance\" [ 1 1 1 ] \"rgb mfp\" [ .1 .1 .1 ]";
    const std::string ball = "Shape \"sphere\" \"float radius\" .5\n";
    expect_means(scene_of(white,
                          ball + "Material \"diffuse\" \"rgb reflectance\" [ 0 0 0 ]\n" +
                              "Shape \"sphere\" \"float radius\" .3\n",
                          1000),
                 Rgb(1), 2e-3f, 64);
    expect_means(
        scene_of(white,
                 "Shape \"sphere\" \"float radius\" .5 \"float zmin\" 0\n"
                 "Material \"subsurface\" \"rgb reflectance\" [ 1 1 1 ] \"rgb mfp\" [ .2 .2 "
                 ".2 ]\nShape \"sphere\" \"float radius\" .5 \"float zmax\" 0\n",
                 1000),
        Rgb(1), 2e-3f, 64);
}

TEST(Subsurface, BatchesAndPredictionMeetNoNonsense) {
    const std::string text =
        scene_of("\"rgb reflectance\" [ .8 .5 .2 ] \"rgb mfp\" [ .1 .1 .1 ] \"float roughness\" .2",
                 "Shape \"sphere\" \"float radius\" .5\nTranslate .2 .2 1\nAreaLightSource "
                 "\"diffuse\" \"rgb "
                 "L\" [ 9 9 9 ]\nShape \"sphere\" \"float radius\" .1\n");
    for (const Method method : {Method::covariance, Method::hybrid}) {
        RenderOptions options = uniform(8);
        options.method = method;
        const RenderResult result = render_text(text, options);
        EXPECT_EQ(summarize_image(result.image).nonfinite, 0);
    }
}

}  // namespace
}  // namespace covtrace
