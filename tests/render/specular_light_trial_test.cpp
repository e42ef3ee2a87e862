// Light is sampled through panes, and by flat mirrors, where that pays.
#include "integrator/guides/specular_light_trial.h"

#include <gtest/gtest.h>

#include <string>

#include "fixtures.h"

namespace covtrace {
namespace {

const char* const kRoom = R"(
Film "rgb" "integer xresolution" 48 "integer yresolution" 27
LookAt 0 1.2 -3.5  0 0.2 0  0 1 0
Camera "perspective" "float fov" 60
WorldBegin
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 30 30 25 ]
Translate 0.4 3.5 0.3
Shape "sphere" "float radius" 0.2
AttributeEnd
Material "diffuse"
Shape "trianglemesh" "point3 P" [ -4 0 -4  4 0 -4  4 0 4  -4 0 4 ] "integer indices" [ 0 1 2 0 2 3 ]
Material "dielectric" "float eta" 1.5
)";

RenderScene scene_with(const std::string& glass, Guides guides = Guides::automatic) {
    return RenderScene(read_pbrt_string(kRoom + glass, "test", "."), {}, kNoTextureLimit, guides);
}

std::string pane(const std::string& height) {
    return "Shape \"trianglemesh\" \"point3 P\" [ -5 " + height + " -5  -5 " + height + " 5  5 " +
           height + " 5  5 " + height + " -5 ] \"integer indices\" [ 0 1 2 0 2 3 ]\n";
}

TEST(PaneTrial, AWindowBeforeALampPays) {
    const RenderScene scene =
        scene_with("ReverseOrientation\n" + pane("2") + "ReverseOrientation\n" + pane("2.2"));
    const GuideOutcome outcome = scene.guide_outcomes().at("panes");
    EXPECT_EQ(outcome.state, GuideState::guides);
    EXPECT_LT(outcome.second_moment, 0.5);
    EXPECT_TRUE(scene.samples_through_panes);
}

TEST(PaneTrial, GlassUnderABoardDoesNot) {
    const RenderScene scene = scene_with(
        R"(Shape "trianglemesh" "point3 P" [ -5 2 -5  -5 2 5  0 2 5  0 2 -5 ] "integer indices" [ 0 1 2 0 2 3 ]
Material "diffuse"
Shape "trianglemesh" "point3 P" [ -6 2.1 -6  -6 2.1 6  0.2 2.1 6  0.2 2.1 -6 ] "integer indices" [ 0 1 2 0 2 3 ])");
    const GuideOutcome outcome = scene.guide_outcomes().at("panes");
    EXPECT_EQ(outcome.state, GuideState::gave_up);
    EXPECT_FALSE(scene.samples_through_panes);
}

TEST(PaneTrial, IsUnusedWithoutPanesAndNotMadeWithoutGuides) {
    EXPECT_EQ(scene_with("").guide_outcomes().at("panes").state, GuideState::unused);
    const RenderScene unguided = scene_with(pane("2.9"), Guides::none);
    EXPECT_EQ(unguided.guide_outcomes().at("panes").state, GuideState::guides);
    EXPECT_TRUE(unguided.samples_through_panes);
}

/// A board that hides the lamp from the floor, and a mirror of a size behind the floor.
std::string mirror(const std::string& half) {
    return R"(Material "diffuse" "rgb reflectance" [ 0.3 0.3 0.3 ]
Shape "trianglemesh" "point3 P" [ -2 2.8 -3  3 2.8 -3  3 2.8 1  -2 2.8 1 ] "integer indices" [ 0 1 2 0 2 3 ]
Material "conductor" "float roughness" 0
Translate 0 2 4
Scale )" + half +
           " " + half + R"( 1
Shape "trianglemesh" "point3 P" [ -1 -1 0  1 -1 0  1 1 0  -1 1 0 ] "integer indices" [ 0 1 2 0 2 3 ]
)";
}

TEST(MirrorTrial, AMirrorThatShowsALampPays) {
    const RenderScene scene = scene_with(mirror("3"));
    const GuideOutcome outcome = scene.guide_outcomes().at("mirrors");
    EXPECT_EQ(outcome.state, GuideState::guides);
    EXPECT_LT(outcome.second_moment, 0.5);
    EXPECT_TRUE(scene.samples_by_mirrors);
    EXPECT_EQ(scene.guide_outcomes().at("panes").state, GuideState::unused);
}

TEST(MirrorTrial, ASmallOneBesideALampDoesNot) {
    const RenderScene scene = scene_with(
        R"(Material "conductor" "float roughness" 0
Shape "trianglemesh" "point3 P" [ 3 0.1 3  3.1 0.1 3  3.1 0.2 3  3 0.2 3 ] "integer indices" [ 0 1 2 0 2 3 ])");
    EXPECT_EQ(scene.guide_outcomes().at("mirrors").state, GuideState::gave_up);
    EXPECT_FALSE(scene.samples_by_mirrors);
}

TEST(MirrorTrial, IsUnusedWithoutMirrorsAndNotMadeWithoutGuides) {
    EXPECT_EQ(scene_with("").guide_outcomes().at("mirrors").state, GuideState::unused);
    const RenderScene unguided = scene_with(mirror("0.01"), Guides::none);
    EXPECT_EQ(unguided.guide_outcomes().at("mirrors").state, GuideState::guides);
    EXPECT_TRUE(unguided.samples_by_mirrors);
}

}  // namespace
}  // namespace covtrace
