// Which rays see a shape or a sky: "hiddenfrom" and "letslightpass", which pbrt-v4 has not.
#include "pbrt_test_support.h"

namespace covtrace::test {
namespace {

TEST(SceneRayVisibility, EveryRaySeesWhatSaysNothing) {
    const auto scene = read_world("LightSource \"infinite\"\nShape \"sphere\"");
    EXPECT_EQ(scene.shapes.at(0).visible_to, kEveryRay);
    EXPECT_EQ(std::get<InfiniteLight>(scene.lights.at(0).value).visible_to, kEveryRay);
}

TEST(SceneRayVisibility, EachKindCanBeHiddenFrom) {
    const std::pair<const char*, RayKind> kinds[] = {
        {"camera", RayKind::camera}, {"diffuse", RayKind::diffuse},
        {"glossy", RayKind::glossy}, {"transmission", RayKind::transmission},
        {"volume", RayKind::volume}, {"shadow", RayKind::shadow}};
    for (const auto& [name, kind] : kinds) {
        const std::string hidden = " \"string hiddenfrom\" \"" + std::string(name) + "\"\n";
        const auto scene =
            read_world("LightSource \"infinite\"" + hidden + "Shape \"sphere\"" + hidden);
        EXPECT_EQ(scene.shapes.at(0).visible_to, kEveryRay & ~set_of(kind)) << name;
        EXPECT_EQ(std::get<InfiniteLight>(scene.lights.at(0).value).visible_to,
                  kEveryRay & ~set_of(kind))
            << name;
        EXPECT_TRUE(scene.warnings.empty());
    }
}

TEST(SceneRayVisibility, ObjectsKeepIt) {
    const auto scene = read_world(
        "ObjectBegin \"o\"\nShape \"sphere\" \"string hiddenfrom\" [ \"camera\" \"shadow\" ]\n"
        "ObjectEnd\nObjectInstance \"o\"");
    EXPECT_EQ(scene.objects.at(0).shapes.at(0).visible_to,
              kEveryRay & ~(set_of(RayKind::camera) | set_of(RayKind::shadow)));
}

TEST(SceneRayVisibility, UnknownKindsAreErrors) {
    EXPECT_TRUE(contains(world_error("Shape \"sphere\" \"string hiddenfrom\" [ \"glosy\" ]"),
                         "test.pbrt:2:16: unknown kind of ray \"glosy\""));
}

TEST(SceneRayVisibility, BordersOfMediaAreThereForEveryRay) {
    const auto scene =
        read_world("Material \"interface\"\nShape \"sphere\" \"string hiddenfrom\" [ \"camera\" ]");
    EXPECT_EQ(scene.shapes.at(0).visible_to, kEveryRay);
    EXPECT_TRUE(contains(warnings_of(scene), "\"hiddenfrom\" is ignored"));
}

TEST(SceneRayVisibility, LampsThatLetLightPassAreNoBorders) {
    const auto scene = read_world(
        "MakeNamedMedium \"m\" \"string type\" \"homogeneous\"\nMediumInterface \"m\" \"\"\n"
        "AreaLightSource \"diffuse\" \"bool letslightpass\" true\nShape \"sphere\"");
    EXPECT_TRUE(scene.area_lights.at(0).lets_light_pass);
    EXPECT_EQ(scene.shapes.at(0).inside, -1);
    EXPECT_FALSE(read_world("AreaLightSource \"diffuse\"\nShape \"sphere\"")
                     .area_lights.at(0)
                     .lets_light_pass);
}

}  // namespace
}  // namespace covtrace::test
