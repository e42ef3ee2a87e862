// Distant lights with an angle, beside balls so far away that they look the same from everywhere.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "../render/fixtures.h"
#include "path_moments.h"

namespace covtrace {
namespace {

using test::Moments, test::trace_many;

struct SunScene {
    const char* name;
    const char* world;
    const char* hidden = "";  ///< "string hiddenfrom" of the sun
    float angle = 20;
    Vec3 towards{1, 1.2f, -0.8f};
};
void PrintTo(const SunScene& s, std::ostream* out) {
    *out << s.name;
}

#define FLOOR                                                                                     \
    "\n"                                                                                          \
    "Material \"diffuse\" \"rgb reflectance\" [ 0.7 0.6 0.5 ]\n"                                  \
    "Shape \"trianglemesh\" \"point3 P\" [ -4 0 -4  4 0 -4  4 0 4  -4 0 4 ] \"integer indices\" " \
    "[ 0 1 2 0 2 3 ]\n"                                                                           \
    "Shape \"trianglemesh\" \"point3 P\" [ -4 0 2  4 0 2  4 5 2  -4 5 2 ] \"integer indices\" [ " \
    "0 1 2 0 2 3 ]\n"
#define BALL(material)                        \
    "AttributeBegin\n"                        \
    "Material " material                      \
    "\n"                                      \
    "Translate 0.2 1 0\n"                     \
    "Shape \"sphere\" \"float radius\" 0.8\n" \
    "AttributeEnd\n"

/// Degrees of suns in a sky, of which balls hide a part.
constexpr float kSmall = 2;

const SunScene kSuns[] = {
    {"shadow", FLOOR BALL(R"("diffuse")")},
    {"shadow_of_the_sun_as_it_is", FLOOR BALL(R"("diffuse")"), "", 0.53f},
    {"rough_metal_and_a_coat", FLOOR BALL(R"("conductor" "float roughness" 0.2)") R"(
Material "coateddiffuse" "float roughness" 0.1
Translate -1.8 0.9 0.3
Shape "sphere" "float radius" 0.7
)"},
    {"mirror", FLOOR BALL(R"("conductor" "float roughness" 0)")},
    {"glass", FLOOR BALL(R"("dielectric" "float eta" 1.5)")},
    {"sky_and_another_sun", R"(LightSource "infinite" "rgb L" [ 0.3 0.4 0.5 ]
LightSource "distant" "point3 from" [ -1 2 0 ] "point3 to" [ 0 0 0 ]
)" FLOOR BALL(R"("diffuse")"),
     "", kSmall},
    {"fog",
     R"(MakeNamedMedium "fog" "string type" "homogeneous" "rgb sigma_a" [ .1 .1 .1 ] "rgb sigma_s" [ .4 .4 .4 ]
AttributeBegin
MediumInterface "fog" ""
Material "interface"
Translate 0 1 0
Shape "sphere" "float radius" 2
AttributeEnd
)" FLOOR},
    {"room_with_a_sky",
     R"(LightSource "infinite" "rgb L" [ 1 1.3 1.6 ]
)" FLOOR
     R"(Shape "trianglemesh" "point3 P" [ -4 5 -4  4 5 -4  4 5 4  -4 5 4 ] "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ -4 0 -4  -4 0 4  -4 5 4  -4 5 -4 ] "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ -4 0 -4  4 0 -4  4 5 -4  -4 5 -4 ] "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ 4 0 -4  4 0 4  4 1 4  4 1 -4 ] "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ 4 4 -4  4 4 4  4 5 4  4 5 -4 ] "integer indices" [ 0 1 2 0 2 3 ]
)",
     "", kSmall},
    {"hidden_from_glossy_rays", FLOOR BALL(R"("conductor" "float roughness" 0.2)"),
     R"( "string hiddenfrom" "glossy")"},
    {"hidden_from_the_camera", FLOOR BALL(R"("conductor" "float roughness" 0)"),
     R"( "string hiddenfrom" "camera")"},
    {"before_the_camera_and_hidden_from_it",
     R"(
Material "diffuse" "rgb reflectance" [ 0.7 0.6 0.5 ]
Shape "trianglemesh" "point3 P" [ -4 0 -4  4 0 -4  4 0 4  -4 0 4 ] "integer indices" [ 0 1 2 0 2 3 ]
)",
     R"( "string hiddenfrom" "camera")",
     20,
     {-0.5f, 0.2f, 0.7f}},
};

class Suns : public testing::TestWithParam<SunScene> {};

constexpr double kIrradiance = 3;

std::string world_of(const SunScene& p, const std::string& sun) {
    return R"(Integrator "volpath" "integer maxdepth" 6
Film "rgb" "integer xresolution" 8 "integer yresolution" 8
LookAt 0 1.2 -3.5  0 0.8 0  0 1 0
Camera "perspective" "float fov" 70
WorldBegin
)" + sun + p.world;
}

/// Eleven scenes, with guides and without, at 4.5 standard errors: false alarms with a probability
/// of 1.5e-4 together, were the means normal.
TEST_P(Suns, ShineAsBallsFarAway) {
    const SunScene& p = GetParam();
    const double sine = std::sin(double(p.angle) / 2 * M_PI / 180);
    const Vec3 w = normalize(p.towards);
    const auto triple = [](Vec3 v) {
        return std::to_string(v.x) + " " + std::to_string(v.y) + " " + std::to_string(v.z);
    };
    const std::string disc = "LightSource \"distant\" \"point3 to\" [ 0 0 0 ] \"point3 from\" [ " +
                             triple(w) + " ] \"float scale\" " + std::to_string(kIrradiance) +
                             " \"float angle\" " + std::to_string(p.angle) + p.hidden + "\n";
    constexpr float kFar = 2e4f;
    const std::string ball = "AttributeBegin\nAreaLightSource \"diffuse\" \"float scale\" " +
                             std::to_string(kIrradiance / (M_PI * sine * sine)) + "\nTranslate " +
                             triple(w * kFar) + "\nShape \"sphere\" \"float radius\" " +
                             std::to_string(double(kFar) * sine) + p.hidden + "\nAttributeEnd\n";
    for (const Guides guides : {Guides::none, Guides::automatic}) {
        SCOPED_TRACE(name_of(guides));
        const auto trace = [&](const std::string& sun, uint64_t key) {
            return trace_many(RenderScene(read_pbrt_string(world_of(p, sun), "test", "."), {},
                                          kNoTextureLimit, guides),
                              key);
        };
        const Moments by_disc = trace(disc, 3), by_ball = trace(ball, 4);
        ASSERT_GT(by_ball.mean(), 0.01);
        const double error = std::sqrt((by_disc.variance() + by_ball.variance()) / by_ball.count);
        EXPECT_NEAR(by_disc.mean(), by_ball.mean(), 4.5 * error + 1e-3 * by_ball.mean());
    }
}
INSTANTIATE_TEST_SUITE_P(Scenes, Suns, testing::ValuesIn(kSuns),
                         [](const auto& instance) { return std::string(instance.param.name); });

}  // namespace
}  // namespace covtrace
