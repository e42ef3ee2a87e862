// Scenes whose image is known: furnaces, closed-form irradiance, exact sums of interreflection.
#include <gtest/gtest.h>

#include "tests/render/fixtures.h"

namespace covtrace {
namespace {

using namespace test;

const std::string kView = R"(
Integrator "path" "integer maxdepth" 200
Film "rgb" "integer xresolution" 24 "integer yresolution" 24
PixelFilter "box"
LookAt 0 0 -4  0 0 0  0 1 0
Camera "perspective" "float fov" 30
WorldBegin
)";

/// Asserts that the mean agrees with the known value within 4.5 standard errors (false alarm 7e-6
/// each) plus `model`.
void expect_mean(const RenderResult& r, double expected, double model = 1e-3) {
    const Summary s = summarize_image(r.image);
    EXPECT_NEAR(s.mean, expected, 4.5 * s.standard_error + model * expected);
    EXPECT_EQ(s.nonfinite, 0);
    EXPECT_TRUE(r.complete);
}

TEST(Analytic, UniformSkyShowsItsRadiance) {
    expect_mean(
        render_text(kView + R"(LightSource "infinite" "rgb L" [ 0.3 0.3 0.3 ])", uniform(4)), 0.3,
        1e-5);
}

TEST(Analytic, ImagingScaleFollowsShutterAndIso) {
    const std::string text = R"(
Film "rgb" "integer xresolution" 8 "integer yresolution" 8 "float iso" 200
Camera "perspective" "float shutteropen" 0 "float shutterclose" 0.25
WorldBegin
LightSource "infinite" "rgb L" [ 1 1 1 ])";
    expect_mean(render_text(text, uniform(4)), 0.5, 1e-5);
}

TEST(Analytic, WhiteDiffuseSphereVanishesInAFurnace) {
    expect_mean(render_text(kView + R"(LightSource "infinite" "rgb L" [ 0.5 0.5 0.5 ]
Material "diffuse" "rgb reflectance" [ 1 1 1 ]
Shape "sphere")",
                            uniform(64)),
                0.5);
}

TEST(Analytic, SmoothGlassSphereVanishesInAFurnace) {
    expect_mean(render_text(kView + R"(LightSource "infinite" "rgb L" [ 0.5 0.5 0.5 ]
Material "dielectric" "float eta" 1.5
Shape "sphere")",
                            uniform(64)),
                0.5);
}

TEST(Analytic, ClosedSphereOfLightSumsAllBounces) {
    // The radiance inside a sphere that emits L and reflects rho is L / (1 - rho) everywhere.
    const std::string text = R"(
Integrator "path" "integer maxdepth" 400
Film "rgb" "integer xresolution" 16 "integer yresolution" 16
Camera "perspective"
WorldBegin
AttributeBegin
ReverseOrientation
AreaLightSource "diffuse" "rgb L" [ 0.2 0.2 0.2 ]
Material "diffuse" "rgb reflectance" [ 0.75 0.75 0.75 ]
Shape "sphere" "float radius" 3
AttributeEnd)";
    expect_mean(render_text(text, uniform(256)), 0.8);
}

TEST(Analytic, DistantLightOnAFacingPlane) {
    // An irradiance of 2 on an albedo of 0.5 gives the radiance 1/pi.
    const std::string plane = R"(
Material "diffuse" "rgb reflectance" [ 0.5 0.5 0.5 ]
Shape "trianglemesh" "point3 P" [ -9 -9 0  9 -9 0  9 9 0  -9 9 0 ] "integer indices" [ 0 1 2 0 2 3 ])";
    expect_mean(
        render_text(
            kView +
                R"(LightSource "distant" "rgb L" [ 2 2 2 ] "point3 from" [ 0 0 -1 ] "point3 to" [ 0 0 0 ])" +
                plane,
            uniform(4)),
        1 / 3.14159265, 1e-4);
}

TEST(Analytic, HalfOfTheLightPassesAlphaFarFromTheOrigin) {
    // Where coordinates are 0.001 apart, all samples of what is seen start in some hundred places.
    const std::string text = R"(
Integrator "path" "integer maxdepth" 1
Film "rgb" "integer xresolution" 16 "integer yresolution" 16
PixelFilter "box"
LookAt 10000 10000 9996  10000 10000 10000  0 1 0
Camera "perspective" "float fov" 0.15
WorldBegin
Translate 10000 10000 10000
LightSource "distant" "rgb L" [ 2 2 2 ] "point3 from" [ 0 1 -1 ] "point3 to" [ 0 0 0 ]
Material "diffuse" "rgb reflectance" [ 0.5 0.5 0.5 ]
Shape "trianglemesh" "point3 P" [ -9 -9 0  9 -9 0  9 9 0  -9 9 0 ] "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ -1 1 -2  1 1 -2  0 3 -2 ] "float alpha" 0.5)";
    expect_mean(render_text(text, uniform(64)), 0.5 * 0.70710678 / 3.14159265);
}

TEST(Analytic, ACameraOnTheFloorDoesNotSeeTheFloor) {
    // The camera sees nothing but the sky, above and below; the floor is black.
    const std::string text = R"(
Film "rgb" "integer xresolution" 16 "integer yresolution" 16
LookAt 0.3 0 0.7  0 0 5  0 1 0
Camera "perspective"
WorldBegin
LightSource "infinite" "rgb L" [ 1 1 1 ]
Material "diffuse" "rgb reflectance" [ 0 0 0 ]
Shape "trianglemesh" "point3 P" [ -9 0 -9  9 0 -9  9 0 9  -9 0 9 ] "integer indices" [ 0 1 2 0 2 3 ])";
    expect_mean(render_text(text, uniform(4)), 1, 1e-5);
}

TEST(Analytic, DefocusAndMotionKeepTheMeanOfAUniformPlane) {
    const std::string text = R"(
Integrator "path" "integer maxdepth" 1
Film "rgb" "integer xresolution" 16 "integer yresolution" 16
LookAt 0 0 -4  0 0 0  0 1 0
Camera "perspective" "float fov" 30 "float lensradius" 0.3 "float focaldistance" 2
WorldBegin
LightSource "infinite" "rgb L" [ 1 1 1 ]
ActiveTransform EndTime
Translate 0.5 0 0
ActiveTransform All
Material "diffuse" "rgb reflectance" [ 0.4 0.4 0.4 ]
Shape "trianglemesh" "point3 P" [ -9 -9 0  9 -9 0  9 9 0  -9 9 0 ] "integer indices" [ 0 1 2 0 2 3 ])";
    expect_mean(render_text(text, uniform(16)), 0.4);
    expect_mean(render_text(text, covariance_method(16)), 0.4);
}

TEST(Analytic, AbsorbingGlassFollowsBeer) {
    // A slab of index 1 and thickness 2 in front of a sky: exp(-sigma d / cos) seen almost head on.
    const std::string text = R"(
Film "rgb" "integer xresolution" 8 "integer yresolution" 8
LookAt 0 0 -40  0 0 0  0 1 0
Camera "perspective" "float fov" 1
WorldBegin
LightSource "infinite" "rgb L" [ 1 1 1 ]
MakeNamedMedium "dye" "string type" "homogeneous" "rgb sigma_a" [ 0.5 0.5 0.5 ] "rgb sigma_s" [ 0 0 0 ]
MediumInterface "dye" ""
Material "interface"
Shape "trianglemesh" "point3 P" [ -9 -9 -1  9 -9 -1  9 9 -1  -9 9 -1 ] "integer indices" [ 0 2 1 0 3 2 ]
Shape "trianglemesh" "point3 P" [ -9 -9 1  9 -9 1  9 9 1  -9 9 1 ] "integer indices" [ 0 1 2 0 2 3 ])";
    expect_mean(render_text(text, uniform(4)), std::exp(-1.0), 1e-3);
}

TEST(Analytic, SumsHaveTheLightOfBothParts) {
    const std::string text = R"(
Film "rgb" "integer xresolution" 8 "integer yresolution" 8
LookAt 0 0 -40  0 0 0  0 1 0
Camera "perspective" "float fov" 1
WorldBegin
LightSource "infinite" "rgb L" [ 1 1 1 ]
MakeNamedMaterial "matt" "string type" "diffuse" "rgb reflectance" [ 0.4 0.4 0.4 ]
MakeNamedMaterial "none" "string type" "interface"
Material "mix" "string materials" [ "matt" "none" ] "float weight" 2
)";
    const std::string pane =
        R"(Shape "trianglemesh" "point3 P" [ -9 -9 0  9 -9 0  9 9 0  -9 9 0 ] "integer indices" [ 0 2 1 0 3 2 ])";
    // Half of the places are matt and half let light pass, each with twice its light
    expect_mean(render_text(text + pane, uniform(256)), 1.4, 0.02);
    // Light is emitted everywhere
    expect_mean(render_text(text + "AreaLightSource \"diffuse\" \"rgb L\" [ 0.3 0.3 0.3 ] " + pane,
                            uniform(256)),
                1.7, 0.02);
}

TEST(Analytic, ColoursMayMultiplyChannelByChannel) {
    const auto blue_over_expected = [](const char* parameters) {
        const std::string text =
            std::string("Integrator \"path\" \"integer maxdepth\" 1 ") + parameters + R"(
Film "rgb" "integer xresolution" 4 "integer yresolution" 4
LookAt 0 0 4  0 0 0  0 1 0
Camera "perspective" "float fov" 1
WorldBegin
LightSource "infinite" "rgb L" [ 1 0.6 0.25 ]
Material "diffuse" "rgb reflectance" [ 0.5 0.2 0.1 ]
Shape "trianglemesh" "point3 P" [ -9 -9 0  9 -9 0  9 9 0  -9 9 0 ] "integer indices" [ 0 1 2 0 2 3 ])";
        return middle_mean(render_text(text, uniform(64)).image, "B") / 0.025;
    };
    EXPECT_NEAR(blue_over_expected("\"bool channelbychannel\" true"), 1, 1e-3);
    EXPECT_LT(blue_over_expected(""), 0.97);
}

TEST(Analytic, LampsShineThroughSums) {
    // The pane lets pass 0.75 of the lamp's light: half of the places 1.5 times
    const std::string text = R"(
Film "rgb" "integer xresolution" 4 "integer yresolution" 4
LookAt 0 0 1  0 0 0  0 1 0
Camera "perspective" "float fov" 1
WorldBegin
LightSource "point" "point3 from" [ 0 0 3 ] "rgb I" [ 9 9 9 ]
Material "diffuse" "rgb reflectance" [ 1 1 1 ]
Shape "trianglemesh" "point3 P" [ -9 -9 0  9 -9 0  9 9 0  -9 9 0 ] "integer indices" [ 0 1 2 0 2 3 ]
)";
    const std::string pane = R"(
MakeNamedMaterial "dark" "string type" "diffuse" "rgb reflectance" [ 0 0 0 ]
MakeNamedMaterial "none" "string type" "interface"
Material "mix" "string materials" [ "dark" "none" ] "float weight" 1.5
Shape "trianglemesh" "point3 P" [ -9 -9 2  9 -9 2  9 9 2  -9 9 2 ] "integer indices" [ 0 1 2 0 2 3 ]
)";
    expect_mean(render_text(text, uniform(4)), 1 / M_PI, 1e-3);
    expect_mean(render_text(text + pane, uniform(1024)), 0.75 / M_PI, 0.01);
}

TEST(Analytic, SoftLampsAreAsBrightThroughPanesByAllEstimators) {
    // A pane that neither reflects nor turns light is as good as none, whichever of the paths and
    // the lights sampled through it find the lamp
    const auto light = [](const std::string& pane, const std::string& roughness) {
        return summarize_image(render_text(R"(
Integrator "path" "integer maxdepth" 3
Film "rgb" "integer xresolution" 16 "integer yresolution" 16
LookAt 0 -1.2 0.35  0 0 0  0 1 0
Camera "perspective" "float fov" 40
WorldBegin
AttributeBegin
Translate 0 0.5 1.1
AreaLightSource "diffuse" "rgb L" [ 5 5 5 ] "bool softfalloff" true "bool letslightpass" true
Shape "sphere" "float radius" 0.5
AttributeEnd
Material )" + pane + R"(
Shape "trianglemesh" "point3 P" [ -3 -3 .55  3 -3 .55  3 3 .55  -3 3 .55 ]
    "integer indices" [ 0 1 2 0 2 3 ]
Material "conductor" "rgb reflectance" [ 0.8 0.8 0.8 ] "bool remaproughness" false
    "float roughness" )" + roughness + R"(
Shape "trianglemesh" "point3 P" [ -3 -3 0  3 -3 0  3 3 0  -3 3 0 ] "integer indices" [ 0 1 2 0 2 3 ]
)",
                                           uniform(64))
                                   .image)
            .mean;
    };
    for (const char* roughness : {"0.3", "0.05", "0.01"})
        EXPECT_NEAR(light("\"thindielectric\" \"float eta\" 1.0001", roughness) /
                        light("\"interface\"", roughness),
                    1, 0.03)
            << roughness;
}

TEST(Analytic, MethodsAgreeOnAnUntexturedFurnace) {
    const std::string text = kView + R"(LightSource "infinite" "rgb L" [ 0.5 0.5 0.5 ]
Material "diffuse" "rgb reflectance" [ 1 1 1 ]
Shape "sphere")";
    // At the silhouette the sphere's light and the sky's have filters of different widths, so that
    // the pixels there are up to a seventh off, to both sides: 0.56 % of all light, and single
    // images 0.1 % more or less.
    double sum = 0;
    constexpr uint64_t kSeeds = 8;
    for (uint64_t seed = 0; seed < kSeeds; ++seed) {
        const RenderResult r = render_text(text, covariance_method(32, seed));
        const Summary s = summarize_image(r.image);
        sum += s.mean / kSeeds;
        EXPECT_EQ(s.nonfinite, 0);
        EXPECT_TRUE(r.complete);
    }
    EXPECT_NEAR(sum, 0.5, 0.5 * 7.2e-3);  // 4 standard errors above (false alarm 6e-5)
}

}  // namespace
}  // namespace covtrace
