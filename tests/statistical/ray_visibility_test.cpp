// Shapes and skies that only some rays see. A thing that is split into two, one for some kinds of
// rays and one for the others, is the thing that it was: whatever strategy finds the light, and
// whatever its weight. Alarms at |z| > 4.4, once in 100000 tests of the mean of an image; seeds are
// fixed.
#include <gtest/gtest.h>

#include <cmath>

#include "pixel_z.h"

namespace covtrace {
namespace {

constexpr double kMostZ = 4.4;

ImageMean mean_of(const std::string& world, int max_depth) {
    const std::string camera = R"(Camera "perspective" "float fov" 60)";
    return image_mean(
        RenderScene(read_pbrt_string(scene_text(camera, world, max_depth), "test", ".")));
}

void expect_equal(const ImageMean& a, const ImageMean& b) {
    const double z = (a.value - b.value) / std::sqrt(a.variance + b.variance);
    EXPECT_LT(std::abs(z), kMostZ) << a.value << " against " << b.value;
    // A test of images that are all noise would say nothing.
    EXPECT_LT(std::sqrt(a.variance + b.variance), 0.03 * b.value);
}

std::string hidden(const std::string& kinds) {
    return kinds.empty() ? "" : " \"string hiddenfrom\" [ " + kinds + " ]";
}

/// Every kind of scattering: a coat over a diffuse wall, rough metal, rough glass, fog.
const std::string kRoom = R"(
AttributeBegin
Material "coateddiffuse" "rgb reflectance" [ 0.7 0.5 0.3 ] "float roughness" 0.3
Shape "trianglemesh" "point3 P" [ -9 -1 -9  9 -1 -9  9 -1 9  -9 -1 9 ] "integer indices" [ 0 1 2 0 2 3 ]
Material "conductor" "float roughness" 0.15
Shape "trianglemesh" "point3 P" [ -9 -1 3  9 -1 3  9 6 3  -9 6 3 ] "integer indices" [ 0 1 2 0 2 3 ]
AttributeEnd
AttributeBegin
Material "dielectric" "float roughness" 0.1
Translate -1 0 0
Shape "sphere" "float radius" 0.8
AttributeEnd
AttributeBegin
MakeNamedMedium "m" "string type" "homogeneous" "rgb sigma_a" [ 0.1 0.2 0.4 ] "rgb sigma_s" [ 1 0.8 0.5 ] "float g" 0.4
MediumInterface "m" ""
Material "interface"
Translate 1.2 0 0
Shape "sphere" "float radius" 0.8
AttributeEnd
)";

std::string lamp(const std::string& kinds, const std::string& parameters = "") {
    return R"(
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 5 4 3 ])" +
           parameters + R"(
Translate 0 2 1
Rotate 70 1 0 0
Shape "disk" "float radius" 0.7)" +
           hidden(kinds) + "\nAttributeEnd\n";
}

std::string sky(const std::string& kinds) {
    return R"(
LightSource "infinite" "rgb L" [ 0.5 0.6 0.8 ])" +
           hidden(kinds) + "\n";
}

std::string ball(const std::string& kinds, const std::string& material) {
    return "\nAttributeBegin\nMaterial " + material + R"(
Translate 0.3 0.6 -0.6
Shape "sphere" "float radius" 0.5)" +
           hidden(kinds) + "\nAttributeEnd\n";
}

const char* const kSome = R"("camera" "glossy" "volume")";
const char* const kOthers = R"("diffuse" "transmission" "shadow")";

TEST(RayVisibility, LampSplitByKindsIsTheLamp) {
    expect_equal(mean_of(kRoom + lamp(kSome) + lamp(kOthers), 5), mean_of(kRoom + lamp(""), 5));
}

TEST(RayVisibility, LampThatLetsLightPassSplitByKindsIsTheLamp) {
    const std::string passes = R"( "bool letslightpass" true "bool twosided" true)";
    expect_equal(mean_of(kRoom + lamp(kSome, passes) + lamp(kOthers, passes), 5),
                 mean_of(kRoom + lamp("", passes), 5));
}

TEST(RayVisibility, SkySplitByKindsIsTheSky) {
    expect_equal(mean_of(kRoom + sky(kSome) + sky(kOthers), 5), mean_of(kRoom + sky(""), 5));
}

// One of the two balls stops shadow rays and the other one some of the rays that a lobe sends to
// the same lamp: light that only one of the strategies finds is weighted alone.
TEST(RayVisibility, OccluderSplitByKindsIsTheOccluder) {
    const char* grey = R"("diffuse" "rgb reflectance" [ 0.2 0.3 0.4 ])";
    const std::string lights = kRoom + lamp("") + sky("");
    expect_equal(mean_of(lights + ball(kSome, grey) + ball(kOthers, grey), 5),
                 mean_of(lights + ball("", grey), 5));
}

// The sum of lamps that each only one kind of ray finds is the lamp; none of the terms is nothing,
// and what they add is not noise.
TEST(RayVisibility, KindsAddUp) {
    const std::string passes = R"( "bool letslightpass" true "bool twosided" true)";
    const char* const kinds[] = {"camera", "diffuse", "glossy", "transmission", "volume"};
    ImageMean sum;
    for (const std::string kind : kinds) {
        std::string others;
        for (const std::string other : kinds)
            if (other != kind) others += " \"" + other + "\"";
        const ImageMean one = mean_of(kRoom + lamp(others, passes), 5);
        EXPECT_GT(one.value, 5 * std::sqrt(one.variance)) << kind;
        sum.value += one.value;
        sum.variance += one.variance;
    }
    expect_equal(sum, mean_of(kRoom + lamp("", passes), 5));
}

const std::string kFloorAndLights = kFloor + lamp("") + sky("");
const char* const kBlack = R"("diffuse" "rgb reflectance" [ 0 0 0 ])";

// A black ball that only scattered rays meet takes nothing from light that is sampled: the floor
// has the light of all of the lamp and of the sky, however much of it the floor's own rays miss.
TEST(RayVisibility, WhatCastsNoShadowTakesNoDirectLight) {
    expect_equal(mean_of(kFloorAndLights + ball(R"("camera" "shadow")", kBlack), 1),
                 mean_of(kFloorAndLights, 1));
}

// The other way about, its shadow is whole, however much of the lamp the floor's own rays find.
TEST(RayVisibility, WhatOnlyCastsAShadowCastsAllOfIt) {
    const ImageMean shadow = mean_of(
        kFloorAndLights + ball(R"("camera" "diffuse" "glossy" "transmission" "volume")", kBlack),
        1);
    expect_equal(shadow, mean_of(kFloorAndLights + ball(R"("camera")", kBlack), 1));
    EXPECT_LT(shadow.value, 0.995 * mean_of(kFloorAndLights, 1).value);
}

// An emitter that lets light pass casts no shadow and hides nothing: lamps that shine away from
// everything leave the image as it is.
TEST(RayVisibility, LampThatLetsLightPassHidesNothing) {
    const std::string turned = R"(
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 5 4 3 ] "bool letslightpass" true
Translate 0 1 -1
Rotate -90 1 0 0
Shape "disk" "float radius" 2
AttributeEnd
)";
    expect_equal(mean_of(kFloorAndLights + turned, 1), mean_of(kFloorAndLights, 1));
}

}  // namespace
}  // namespace covtrace
