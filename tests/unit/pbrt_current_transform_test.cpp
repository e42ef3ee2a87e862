// Matrices that flatten space: an error only where something is placed by them.
#include "pbrt/current_transform.h"

#include <array>

#include "pbrt_test_support.h"

namespace covtrace::test {
namespace {

struct Case {
    const char* directives;
    const char* place;  ///< place to blame, with the fault
};

constexpr std::array<Case, 6> kFlat{{
    {"ConcatTransform [0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 1]", "test.pbrt:2:1: the matrix is singular"},
    {"Transform [0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0]", "test.pbrt:2:1: the matrix is singular"},
    {"Transform [1 2 3 0 2 4 6 0 0 0 1 0 0 0 0 1]", "test.pbrt:2:1: the matrix is singular"},
    {"Transform [1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1]", "test.pbrt:2:1: the matrix is projective"},
    {"Scale 1 0 1", "test.pbrt:2:1: Scale by zero"},
    {"Scale 1e20 1 1 Scale 1e20 1 1", "test.pbrt:2:16: the numbers of the current transformation"},
}};

TEST(SceneCurrentTransform, WhatPlacesNothingIsNoError) {
    for (const Case& c : kFlat) {
        const auto scene =
            read_world(std::string(c.directives) +
                       "\nTranslate 1 2 3 CoordinateSystem \"flat\" CoordSysTransform \"flat\"\n"
                       "Material \"diffuse\"\n"
                       "Texture \"u\" \"spectrum\" \"checkerboard\"\n"
                       "AreaLightSource \"diffuse\"\n"
                       "Identity Shape \"sphere\"");
        ASSERT_EQ(scene.shapes.size(), 1u) << c.directives;
        EXPECT_TRUE(scene.shapes[0].object_to_world.start().is_identity()) << c.directives;
    }
}

TEST(SceneCurrentTransform, WhatIsPlacedByThemNamesBothPlaces) {
    const std::array<const char*, 6> users{
        "Shape \"sphere\"",
        "LightSource \"point\"",
        "ObjectInstance \"o\"",
        "Texture \"t\" \"spectrum\" \"checkerboard\" \"integer dimension\" 3",
        "Texture \"t\" \"spectrum\" \"checkerboard\" \"string mapping\" \"planar\"",
        "Texture \"t\" \"float\" \"fbm\""};
    for (const Case& c : kFlat)
        for (const char* user : users) {
            const std::string message =
                world_error(std::string(c.directives) + "\nTranslate 1 2 3 " + user +
                            "\nIdentity ObjectBegin \"o\" ObjectEnd");
            EXPECT_TRUE(contains(message, c.place)) << user;
            EXPECT_TRUE(contains(message, "it is used at test.pbrt:3:17")) << c.directives;
        }
}

TEST(SceneCurrentTransform, CamerasAndBothEndsOfAMotionArePlaced) {
    EXPECT_TRUE(contains(options_error("Scale 1 0 1\nCamera \"perspective\""),
                         "test.pbrt:1:1: Scale by zero is a singular transformation; it is used "
                         "at test.pbrt:2:1"));
    EXPECT_NO_THROW(read_options("Scale 1 0 1"));
    EXPECT_TRUE(contains(world_error("ActiveTransform EndTime\nScale 0 1 1 Shape \"sphere\""),
                         "test.pbrt:3:1: Scale by zero"));
}

TEST(SceneCurrentTransform, TheBlockEndsThem) {
    const auto scene = read_world(
        "AttributeBegin ConcatTransform [0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 1] AttributeEnd\n"
        "Shape \"sphere\"");
    EXPECT_EQ(scene.shapes.size(), 1u);
    EXPECT_TRUE(scene.warnings.empty()) << warnings_of(scene);
}

}  // namespace
}  // namespace covtrace::test
