// Light that is sampled through panes: the same image as by paths alone, with less noise.
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "../render/fixtures.h"
#include "path_moments.h"
#include "sampled_light.h"

namespace covtrace {
namespace {

using test::SampledLightScene, test::expect_same_light;

/// A floor, looked at from above, and a wall beside it.
const char* const kRoom = R"(
Material "diffuse" "rgb reflectance" [ 0.7 0.6 0.5 ]
Shape "trianglemesh" "point3 P" [ -4 0 -4  4 0 -4  4 0 4  -4 0 4 ] "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ -4 0 2  4 0 2  4 5 2  -4 5 2 ] "integer indices" [ 0 1 2 0 2 3 ]
)";
/// A slab of glass over the floor, 0.2 thick.
#define SLAB                                                                                      \
    "Material \"dielectric\" \"float eta\" 1.5\n"                                                 \
    "Shape \"trianglemesh\" \"point3 P\" [ -5 2 -5  -5 2 5  5 2 5  5 2 -5 ] \"integer indices\" " \
    "[ 0 2 1 0 3 2 ]\n"                                                                           \
    "Shape \"trianglemesh\" \"point3 P\" [ -5 2.2 -5  -5 2.2 5  5 2.2 5  5 2.2 -5 ] \"integer "   \
    "indices\" [ 0 1 2 0 2 3 ]\n"
#define LAMP                                               \
    "AttributeBegin\n"                                     \
    "AreaLightSource \"diffuse\" \"rgb L\" [ 30 30 25 ]\n" \
    "Translate 0.4 3.5 0.3\n"                              \
    "Shape \"sphere\" \"float radius\" 0.3\n"              \
    "AttributeEnd\n"
#define SUN                                                                                       \
    "LightSource \"distant\" \"point3 from\" [ 1 3 -0.5 ] \"point3 to\" [ 0 0 0 ] \"rgb L\" [ 4 " \
    "4 3 ] \"float angle\" 4\n"

const SampledLightScene kPanes[] = {
    {"slab", LAMP SLAB, 6, 0.2},
    {"slab_at_the_last_bounce", LAMP SLAB, 3, 0.2},
    {"slab_beyond_the_last_bounce", LAMP SLAB, 2},
    {"slab_in_the_sky", R"(LightSource "infinite" "rgb L" [ 1 1.2 1.5 ])" SLAB},
    {"slab_in_the_sun", SUN SLAB, 6, 0.2},
    {"slab_in_the_sun_and_the_sky", R"(LightSource "infinite" "rgb L" [ 1 1.2 1.5 ])" SUN SLAB},
    {"thin", LAMP R"(Material "thindielectric" "float eta" 1.4
Shape "trianglemesh" "point3 P" [ -5 2 -5  -5 2 5  5 2 5  5 2 -5 ] "integer indices" [ 0 2 1 0 3 2 ]
)",
     6, 0.2},
    {"ball", LAMP R"(Translate 0.4 1.4 0.2
Material "dielectric" "float eta" 1.5
Shape "sphere" "float radius" 0.8
)"},
    {"bulb", R"(Translate 0.4 2.8 0.2
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 60 50 40 ]
Shape "sphere" "float radius" 0.15
AttributeEnd
Material "dielectric" "float eta" 1.5
Shape "sphere" "float radius" 0.4
ReverseOrientation
Shape "sphere" "float radius" 0.37
)",
     8, 0.2},
    {"lamps_and_sky_beside_what_the_camera_alone_sees", R"(
LightSource "infinite" "rgb L" [ 0.3 0.4 0.5 ]
)" SLAB R"(
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 5 4 3 ] "bool letslightpass" true
Shape "trianglemesh" "point3 P" [ -2 3 -2  2 3 -2  2 3 2  -2 3 2 ] "integer indices" [ 0 1 2 0 2 3 ]
AttributeEnd
Material "diffuse"
Shape "trianglemesh" "point3 P" [ -5 4 -5  5 4 -5  5 4 5  -5 4 5 ] "integer indices" [ 0 1 2 0 2 3 ]
    "string hiddenfrom" [ "diffuse" "glossy" "transmission" "volume" "shadow" ]
)"},
    {"lamp_behind_a_net", SLAB R"(
MakeNamedMaterial "thread" "string type" "diffuse"
MakeNamedMaterial "hole" "string type" "interface"
Material "mix" "string materials" [ "thread" "hole" ] "float amount" 0.5
Shape "trianglemesh" "point3 P" [ -5 2.6 -5  5 2.6 -5  5 2.6 5  -5 2.6 5 ] "integer indices" [ 0 1 2 0 2 3 ]
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 30 30 25 ]
Translate 0.4 3.5 0.3
Shape "sphere" "float radius" 0.3
AttributeEnd
LightSource "infinite" "rgb L" [ 0.3 0.4 0.5 ]
)"},
    {"lamp_behind_curtains", LAMP SLAB R"(
Material "diffuse" "rgb reflectance" [ 0.1 0.1 0.1 ]
Shape "trianglemesh" "point3 P" [ -5 1.8 -5  5 1.8 -5  5 1.8 5  -5 1.8 5 ] "integer indices" [ 0 1 2 0 2 3 ]
    "float alpha" 0.3
MakeNamedMaterial "thread" "string type" "diffuse" "rgb reflectance" [ 0.1 0.1 0.1 ]
MakeNamedMaterial "hole" "string type" "interface"
Material "mix" "string materials" [ "thread" "hole" ] "float amount" 0.5
Shape "trianglemesh" "point3 P" [ -5 2.6 -5  5 2.6 -5  5 2.6 5  -5 2.6 5 ] "integer indices" [ 0 1 2 0 2 3 ]
    "float alpha" 0.5
)"},
    {"coloured_glass_and_lamps_that_let_light_pass", R"(
LightSource "infinite" "rgb L" [ 0.3 0.4 0.5 ]
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 5 4 3 ] "bool letslightpass" true
Shape "trianglemesh" "point3 P" [ -1 3 -1  1 3 -1  1 3 1  -1 3 1 ] "integer indices" [ 0 1 2 0 2 3 ]
AttributeEnd
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 5 4 3 ] "bool letslightpass" true
Shape "trianglemesh" "point3 P" [ -1 1 -1  1 1 -1  1 1 1  -1 1 1 ] "integer indices" [ 0 1 2 0 2 3 ]
AttributeEnd
MakeNamedMedium "ink" "string type" "homogeneous" "rgb sigma_a" [ 3 1 0.2 ] "rgb sigma_s" [ 0.5 0.5 0.5 ]
AttributeBegin
MediumInterface "ink" ""
)" SLAB "AttributeEnd\n" LAMP},
};

class Panes : public testing::TestWithParam<SampledLightScene> {};

/// Thirteen scenes, with guides and without, at 4.5 standard errors: false alarms with a
/// probability of 1.8e-4 together, were the means normal; 262144 paths make them nearly so.
TEST_P(Panes, SampledLightLeavesTheImageAsItIs) {
    const SampledLightScene& p = GetParam();
    const std::string text = "Integrator \"volpath\" \"integer maxdepth\" " +
                             std::to_string(p.max_depth) + R"(
Film "rgb" "integer xresolution" 8 "integer yresolution" 8
LookAt 0 1.2 -3.5  0 0.2 0  0 1 0
Camera "perspective" "float fov" 60
WorldBegin
)" + kRoom + p.world;
    for (const Guides guides : {Guides::none, Guides::automatic}) {
        SCOPED_TRACE(name_of(guides));
        RenderScene scene(read_pbrt_string(text, "test", "."), {}, kNoTextureLimit, guides);
        expect_same_light(
            scene, &RenderScene::samples_through_panes,
            guides == Guides::none ? p.most_noise : std::numeric_limits<double>::max());
    }
}
INSTANTIATE_TEST_SUITE_P(Scenes, Panes, testing::ValuesIn(kPanes),
                         [](const auto& instance) { return std::string(instance.param.name); });

/// The guide to caustics probes for light that is left to paths: that of the sun behind a slab is
/// not, and is all there where it is not sampled.
TEST(PathsFromAPlace, LeaveLightBehindPanesToSampling) {
    RenderScene scene(read_pbrt_string(std::string("WorldBegin\n") + kRoom + SUN SLAB, "test", "."),
                      {}, kNoTextureLimit, Guides::none);
    const Vec3 up{0, 1, 0}, to_sun = normalize(Vec3{1, 3, -0.5f});
    const Ray ray{{0, 1e-3f, 0}, to_sun, 0, kInfinity, RayKind::diffuse};
    const auto light = [&](bool is_sampled) {
        scene.samples_through_panes = is_sampled;
        double sum = 0;
        for (int i = 0; i < 256; ++i)
            sum += luminance(trace_path_from(scene, {ray.origin, up}, dot(up, to_sun) / kPi, ray,
                                             Sampler(3, i, 0, 0), 6)
                                 .radiance);
        return sum / 256;
    };
    const double whole = light(false);
    // 4 / (pi sin^2(2 degrees)), less what two faces of glass reflect
    EXPECT_NEAR(whole, 960, 60);
    EXPECT_LT(light(true), 0.02 * whole);  // what is reflected twice in the slab
}

}  // namespace
}  // namespace covtrace
