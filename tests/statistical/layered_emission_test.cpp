// Emission below a clear coat and a sheen is dimmed by what these reflect, and light sampling
// finds it as dim as rays do. Alarms at |z| > 4.4, once in 100000 tests; seeds are fixed.
#include <gtest/gtest.h>

#include <cmath>

#include "bsdf/sheen.h"
#include "pixel_z.h"

namespace covtrace {
namespace {

constexpr float kSheenAlpha = 0.25f, kSheenColour = 0.8f, kWeight = 0.7f;
constexpr double kHalf = 0.8, kHeight = 0.5, kAside = 0.9;  // of the lamp

enum Layers : unsigned { none = 0, coat = 1, sheen = 2 };

/// The share that gets through the layers at a cosine, by the extensions' formulas.
double expected_share(unsigned layers, double cosine) {
    static const SheenTable table;
    double share = 1;
    if (layers & coat) share *= 1 - kWeight * (0.04 + 0.96 * std::pow(1 - cosine, 5));
    if (layers & sheen)
        share *= 1 - kSheenColour * double(table.albedo(kSheenAlpha, static_cast<float>(cosine)));
    return share;
}

/// A square lamp of radiance 1 below layers, over the middle of a floor and aside. With `is_mixed`
/// the lamp's material is a mix, of which one part has the layers.
RenderScene scene_of(const std::string& view, unsigned layers, bool is_mixed) {
    const std::string text = R"(
Integrator "path" "integer maxdepth" 1
Film "rgb" "integer xresolution" 8 "integer yresolution" 8
PixelFilter "box" "float xradius" 0.5 "float yradius" 0.5
)" + view + R"(
WorldBegin
Material "diffuse" "rgb reflectance" [ 0.5 0.5 0.5 ]
Shape "trianglemesh" "point3 P" [ -9 -9 0  9 -9 0  9 9 0  -9 9 0 ] "integer indices" [ 0 1 2 0 2 3 ]
MakeNamedMaterial "plain" "string type" "diffuse" "rgb reflectance" [ 0 0 0 ]
MakeNamedMaterial "layered" "string type" "diffuse" "rgb reflectance" [ 0 0 0 ]
MakeNamedMaterial "mixed" "string type" "mix" "string materials" [ "plain" "layered" ] "float amount" 0.5
NamedMaterial ")" + (is_mixed ? "mixed" : "layered") +
                             R"("
AreaLightSource "diffuse" "rgb L" [ 1 1 1 ]
Translate 0.9 0 0.5
Shape "trianglemesh" "point3 P" [ -0.8 -0.8 0  0.8 -0.8 0  0.8 0.8 0  -0.8 0.8 0 ]
    "integer indices" [ 0 2 1 0 3 2 ]
)";
    SceneDescription scene = read_pbrt_string(text, "test", ".");
    const auto constant = [&scene](float v) {
        scene.textures.push_back({{}, false, ConstantTexture{Rgb(v)}, {}});
        return static_cast<TextureId>(scene.textures.size() - 1);
    };
    for (MaterialDescription& m : scene.materials) {
        if (m.name != "layered") continue;
        if (layers & coat) m.clearcoat = ClearcoatLayer{.weight = constant(kWeight)};
        if (layers & sheen) m.sheen = SheenLayer{constant(kSheenColour), constant(kSheenAlpha)};
    }
    return RenderScene(std::move(scene));
}

TEST(LayeredEmission, IsDimmedAsItIsSeen) {
    for (const double angle : {0.0, 0.7, 1.3}) {
        const std::string eye = std::to_string(0.9 + 0.4 * std::sin(angle)) + " 0 " +
                                std::to_string(0.5 - 0.4 * std::cos(angle));
        const std::string view = "LookAt " + eye + R"(  0.9 0 0.5  0 1 0
Camera "orthographic" "float screenwindow" [ -0.05 0.05 -0.05 0.05 ])";
        for (const unsigned layers : {none | 0u, coat | 0u, sheen | 0u, coat | sheen}) {
            const double share = expected_share(layers, std::cos(angle));
            const double seen = image_mean(scene_of(view, layers, false), 1, 1).value;
            EXPECT_NEAR(seen, share, 2e-4) << angle << " " << layers;
            const double mixed = image_mean(scene_of(view, layers, true), 1, 1).value;
            EXPECT_NEAR(mixed, (1 + share) / 2, 2e-4) << angle << " " << layers;
        }
    }
}

/// Radiance of the middle of the floor, by quadrature over the lamp.
double lit_floor(unsigned layers) {
    constexpr int kSteps = 400;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i)
        for (int k = 0; k < kSteps; ++k) {
            const double x = kAside + kHalf * (2 * (i + 0.5) / kSteps - 1),
                         y = kHalf * (2 * (k + 0.5) / kSteps - 1);
            const double d2 = x * x + y * y + kHeight * kHeight;
            const double cosine = kHeight / std::sqrt(d2);
            sum += expected_share(layers, cosine) * cosine * cosine / d2;
        }
    const double area = 4 * kHalf * kHalf / (kSteps * kSteps);
    return 0.5 / double(kPi) * sum * area;
}

TEST(LayeredEmission, LightsAsDimAsItIsSeen) {
    const std::string view = R"(LookAt 0 0 0.1  0 0 0  0 1 0
Camera "orthographic" "float screenwindow" [ -0.01 0.01 -0.01 0.01 ])";
    for (const unsigned layers : {none | 0u, coat | 0u, sheen | 0u, coat | sheen}) {
        const ImageMean floor = image_mean(scene_of(view, layers, false));
        const double expected = lit_floor(layers);
        EXPECT_LT(std::abs(floor.value - expected) / std::sqrt(floor.variance), 4.4)
            << layers << ": " << floor.value << " against " << expected;
        EXPECT_LT(std::sqrt(floor.variance), 2e-3 * expected);
    }
    EXPECT_LT(lit_floor(coat | sheen), 0.9 * lit_floor(none));
}

}  // namespace
}  // namespace covtrace
