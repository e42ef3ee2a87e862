// Light that is sampled by flat mirrors: the same image as by paths alone, with less noise.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "../render/fixtures.h"
#include "path_moments.h"
#include "sampled_light.h"

namespace covtrace {
namespace {

using test::Moments, test::SampledLightScene, test::expect_same_light, test::trace_many;

/// A floor, looked at from above.
const char* const kFloor = R"(
Material "diffuse" "rgb reflectance" [ 0.7 0.6 0.5 ]
Shape "trianglemesh" "point3 P" [ -4 0 -4  4 0 -4  4 0 4  -4 0 4 ] "integer indices" [ 0 1 2 0 2 3 ]
)";
/// A mirror behind the floor.
#define MIRROR                                                                            \
    "Material \"conductor\" \"float roughness\" 0 \"rgb reflectance\" [ 0.9 0.8 0.7 ]\n"  \
    "Shape \"trianglemesh\" \"point3 P\" [ -3 0.2 2  3 0.2 2  3 4 2  -3 4 2 ] \"integer " \
    "indices\" [ 0 1 2 0 2 3 ]\n"
/// A lamp that much of the floor sees in the mirror alone, as a board hides it.
#define LAMP                                                                                  \
    "AttributeBegin\n"                                                                        \
    "AreaLightSource \"diffuse\" \"rgb L\" [ 30 30 25 ]\n"                                    \
    "Translate 0.4 2.5 -0.5\n"                                                                \
    "Shape \"sphere\" \"float radius\" 0.2\n"                                                 \
    "AttributeEnd\n"                                                                          \
    "Material \"diffuse\" \"rgb reflectance\" [ 0.3 0.3 0.3 ]\n"                              \
    "Shape \"trianglemesh\" \"point3 P\" [ -1 1.8 -1.5  2 1.8 -1.5  2 1.8 0.2  -1 1.8 0.2 ] " \
    "\"integer indices\" [ 0 1 2 0 2 3 ]\n"
#define SUN(angle)                                                                                                   \
    R"(LightSource "distant" "point3 from" [ 1 2 -4 ] "point3 to" [ 0 0 0 ] "rgb L" [ 4 4 3 ] "float angle" )" angle \
    "\n"
#define SKY "LightSource \"infinite\" \"rgb L\" [ 1 1.2 1.5 ]\n"

const SampledLightScene kMirrors[] = {
    {"mirror", LAMP MIRROR, 5, 0.4},
    {"at_the_last_bounce", LAMP MIRROR, 2, 0.4},
    {"beyond_the_last_bounce", LAMP MIRROR, 1},
    {"in_the_sun", SUN("4") MIRROR, 5, 0.4},
    {"in_a_sun_without_extent", SUN("0") LAMP MIRROR, 5, 0.6},
    {"in_the_sky", SKY MIRROR},
    {"in_the_sky_and_the_sun", SKY SUN("4") MIRROR, 5, 0.4},
    {"two_that_face_each_other", LAMP MIRROR R"(
Shape "trianglemesh" "point3 P" [ -3 0 -4  3 0 -4  3 3 -4  -3 3 -4 ] "integer indices" [ 0 1 2 0 2 3 ]
)"},
    {"two_in_planes_beside_each_other", LAMP R"(
Material "conductor" "float roughness" 0 "rgb reflectance" [ 0.9 0.8 0.7 ]
Shape "trianglemesh" "point3 P" [ -3 0.2 2  0 0.2 2  0 4 2  -3 4 2 ] "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ 0 0.2 2.1  3 0.2 2.1  3 4 2.1  0 4 2.1 ] "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ 0 0 900  0.1 0 900  0 0.1 900 ]
)",
     5, 0.4},
    {"patches_with_normals_and_a_part_that_is_bent", LAMP R"(
Material "conductor" "float roughness" 0
Shape "bilinearmesh" "point3 P" [ -3 0.2 2  0 0.2 2  -3 4 2  0 4 2  3 0.2 2  3 4 1.5 ]
    "integer indices" [ 0 1 2 3 1 4 3 5 ]
    "normal N" [ 0 0 1  0 0 1  0 0 1  0 0 1  0 0 1  0 0.1 1 ]
)"},
    {"glass", LAMP R"(Material "dielectric" "float eta" 1.5
Shape "trianglemesh" "point3 P" [ -3 0.2 2  3 0.2 2  3 4 2  -3 4 2 ] "integer indices" [ 0 2 1 0 3 2 ]
Shape "trianglemesh" "point3 P" [ -3 0.2 2.2  3 0.2 2.2  3 4 2.2  -3 4 2.2 ] "integer indices" [ 0 1 2 0 2 3 ]
Material "thindielectric" "float eta" 2
Shape "trianglemesh" "point3 P" [ -3 0.2 -3  -3 0.2 2  -3 4 2  -3 4 -3 ] "integer indices" [ 0 1 2 0 2 3 ]
)"},
    {"glossy_floor", LAMP MIRROR R"(
Material "coateddiffuse" "float roughness" 0.1
Shape "trianglemesh" "point3 P" [ -2 0.1 -2  2 0.1 -2  2 0.1 1.5  -2 0.1 1.5 ] "integer indices" [ 0 1 2 0 2 3 ]
Material "diffusetransmission"
Shape "trianglemesh" "point3 P" [ -3 0.4 0  -2 0.4 0  -2 2 0  -3 2 0 ] "integer indices" [ 0 1 2 0 2 3 ]
)"},
    {"in_fog_and_behind_a_net", LAMP MIRROR R"(
MakeNamedMedium "fog" "string type" "homogeneous" "rgb sigma_a" [ 0.05 0.1 0.2 ] "rgb sigma_s" [ 0.1 0.1 0.1 ]
AttributeBegin
MediumInterface "fog" ""
Material "interface"
Shape "trianglemesh" "point3 P" [ -3 0.1 1  3 0.1 1  3 4 1  -3 4 1 ] "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ -3 0.1 0.5  3 0.1 0.5  3 4 0.5  -3 4 0.5 ] "integer indices" [ 0 2 1 0 3 2 ]
AttributeEnd
MakeNamedMaterial "thread" "string type" "diffuse"
MakeNamedMaterial "hole" "string type" "interface"
Material "mix" "string materials" [ "thread" "hole" ] "float amount" 0.5
Shape "trianglemesh" "point3 P" [ -3 0.1 0.2  3 0.1 0.2  3 4 0.2  -3 4 0.2 ] "integer indices" [ 0 1 2 0 2 3 ]
)"},
    {"lamps_that_let_light_pass", SKY LAMP MIRROR R"(
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 5 4 3 ] "bool letslightpass" true "bool twosided" true
Shape "trianglemesh" "point3 P" [ -2 0.5 1  2 0.5 1  2 2 1  -2 2 1 ] "integer indices" [ 0 1 2 0 2 3 ]
AttributeEnd
)"},
    // Images of the floor lie outside of the sphere, which samples for them would meet there
    {"in_a_sphere_that_shines_inwards", MIRROR R"(
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 1 1 1 ]
ReverseOrientation
Translate 0 0 -2
Shape "sphere" "float radius" 4.5
AttributeEnd
)"},
    {"a_mirror_that_moves", LAMP R"(Material "conductor" "float roughness" 0
ActiveTransform EndTime
Translate 0 0 0.5
ActiveTransform All
Shape "trianglemesh" "point3 P" [ -3 0.2 2  3 0.2 2  3 4 2  -3 4 2 ] "integer indices" [ 0 1 2 0 2 3 ]
)"},
};

class Mirrors : public testing::TestWithParam<SampledLightScene> {};

/// Sixteen scenes, with guides and without, at 4.5 standard errors: false alarms with a
/// probability of 2.2e-4 together, were the means normal; 262144 paths make them nearly so.
TEST_P(Mirrors, SampledLightLeavesTheImageAsItIs) {
    const SampledLightScene& p = GetParam();
    const std::string text = "Integrator \"volpath\" \"integer maxdepth\" " +
                             std::to_string(p.max_depth) + R"(
Film "rgb" "integer xresolution" 8 "integer yresolution" 8
LookAt 0 1.2 -3.5  0 0.2 0  0 1 0
Camera "perspective" "float fov" 25
WorldBegin
)" + p.world + kFloor;
    for (const Guides guides : {Guides::none, Guides::automatic}) {
        SCOPED_TRACE(name_of(guides));
        RenderScene scene(read_pbrt_string(text, "test", "."), {}, kNoTextureLimit, guides);
        const bool has_mirrors = !scene.mirrors.is_empty();
        EXPECT_EQ(has_mirrors, std::string(p.name) != "a_mirror_that_moves");
        expect_same_light(
            scene, &RenderScene::samples_by_mirrors,
            guides == Guides::none ? p.most_noise : std::numeric_limits<double>::max(),
            has_mirrors);
    }
}
INSTANTIATE_TEST_SUITE_P(Scenes, Mirrors, testing::ValuesIn(kMirrors),
                         [](const auto& instance) { return std::string(instance.param.name); });

/// A mirror shows a narrow sun, which paths hardly ever meet, as a window in its place shows the
/// sun's image: 4.5 standard errors, a false alarm in 7e-6 of all seeds for each of three angles.
TEST(MirroredSun, LightsAFloorAsThroughAWindow) {
    const auto traced = [](int max_depth, const std::string& from_z, const std::string& angle,
                           const char* wall, uint64_t key) {
        const RenderScene scene(read_pbrt_string("Integrator \"path\" \"integer maxdepth\" " +
                                                     std::to_string(max_depth) + R"(
Film "rgb" "integer xresolution" 8 "integer yresolution" 8
LookAt 0 3.5 -1  0 0 0.3  0 1 0
Camera "perspective" "float fov" 36
WorldBegin
LightSource "distant" "point3 to" [ 0 0 0 ] "point3 from" [ 1 2 )" +
                                                     from_z + R"( ] "float angle" )" + angle + R"(
Material "diffuse" "rgb reflectance" [ 0.7 0.6 0.5 ]
Shape "trianglemesh" "point3 P" [ -4 0 -4  4 0 -4  4 0 2  -4 0 2 ] "integer indices" [ 0 1 2 0 2 3 ]
)" + wall,
                                                 "test", "."),
                                {}, kNoTextureLimit, Guides::none);
        return trace_many(scene, key);
    };
    const char* const kMirror =
        R"(Material "conductor" "float roughness" 0 "rgb reflectance" [ 1 1 1 ]
Shape "trianglemesh" "point3 P" [ -1.5 0.7 2  1 0.7 2  1 2 2  -1.5 2 2 ] "integer indices" [ 0 1 2 0 2 3 ]
)";
    const char* const kWindow = R"(Material "diffuse" "rgb reflectance" [ 0 0 0 ]
Shape "trianglemesh" "point3 P" [
    -99 -1 2  -1.5 -1 2  -1.5 99 2  -99 99 2  1 -1 2  99 -1 2  99 99 2  1 99 2
    -1.5 -1 2  1 -1 2  1 0.7 2  -1.5 0.7 2  -1.5 2 2  1 2 2  1 99 2  -1.5 99 2 ]
    "integer indices" [ 0 1 2 0 2 3  4 5 6 4 6 7  8 9 10 8 10 11  12 13 14 12 14 15 ]
)";
    for (const char* angle : {"5", "1", "0.1"}) {
        const Moments with_mirror = traced(2, "-4", angle, kMirror, 7),
                      straight = traced(1, "-4", angle, kMirror, 8),
                      by_window = traced(1, "4", angle, kWindow, 9);
        const double error = std::hypot(with_mirror.error(), straight.error(), by_window.error());
        EXPECT_LT(error, 0.005 * by_window.mean()) << angle;
        EXPECT_NEAR(with_mirror.mean() - straight.mean(), by_window.mean(), 4.5 * error) << angle;
    }
}

}  // namespace
}  // namespace covtrace
