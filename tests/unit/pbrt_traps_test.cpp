// Traps that real pbrt-v4 files hold for their reader, one test each.
#include "pbrt_test_support.h"

namespace covtrace {
namespace {

using namespace test;

TEST(SceneTraps, T01ActiveTransformWithUnquotedWords) {
    const auto scene = read_world(R"(ActiveTransform StartTime
Translate 1 0 0
ActiveTransform EndTime
Translate 2 0 0
ActiveTransform All
Shape "sphere")");
    expect_near(scene.shapes.at(0).object_to_world.start().point({}), {1, 0, 0}, 1e-6f);
    expect_near(scene.shapes.at(0).object_to_world.end().point({}), {2, 0, 0}, 1e-6f);
}

TEST(SceneTraps, T02IncludeInTheMiddleOfAParameterList) {
    const TemporaryFolder folder;
    folder.write("start.pbrt", R"(MakeNamedMedium "smoke" "string type" "homogeneous")");
    const auto scene = read_pbrt(folder.write("scene.pbrt", R"(WorldBegin
Include "start.pbrt"
"rgb sigma_a" [ 1 2 3 ] "rgb sigma_s" [ 0 0 0 ]
Shape "sphere"
)"));
    EXPECT_EQ(scene.media.at(0).sigma_a, Rgb(1, 2, 3));
    EXPECT_EQ(scene.shapes.size(), 1u);
}

TEST(SceneTraps, T03ParameterNameWithALeadingBlank) {
    const auto scene = read_world(R"(Shape "sphere" " float radius" 3)");
    EXPECT_EQ(std::get<Sphere>(scene.shapes.at(0).geometry).radius, 3);
}

TEST(SceneTraps, T04ValuesWithoutBrackets) {
    const auto scene = read_options(
        "Camera \"perspective\" \"float fov\" 25\n"
        "Integrator \"path\" \"bool regularize\" true \"integer maxdepth\" 7");
    EXPECT_EQ(scene.camera.fov, 25);
    EXPECT_EQ(scene.max_depth, 7);
}

TEST(SceneTraps, T05EmptyMaterialIsAnInterface) {
    const auto scene = read_world(R"(MakeNamedMedium "foo" "string type" "homogeneous"
Material ""
MediumInterface "foo" ""
Shape "sphere")");
    const ShapeDescription& s = scene.shapes.at(0);
    EXPECT_TRUE(
        std::holds_alternative<InterfaceMaterial>(scene.materials.at(size_t(s.material)).value));
    EXPECT_EQ(s.inside, 0);
    EXPECT_EQ(s.outside, -1);
}

TEST(SceneTraps, T06TheLastOfSeveralCamerasCounts) {
    const auto scene = read_options(
        "Camera \"realistic\" \"string lensfile\" \"absent.dat\"\n"
        "Camera \"perspective\" \"float fov\" 33");
    EXPECT_EQ(scene.camera.fov, 33);
}

TEST(SceneTraps, T07TheSameParameterTwice) {
    const auto scene =
        read_world(R"(LightSource "infinite" "rgb L" [ 1 1 1 ] "float scale" 2 "float scale" 3)");
    expect_near(std::get<InfiniteLight>(scene.lights.at(0).value).radiance, Rgb(3), 1e-6f);
    EXPECT_TRUE(contains(warnings_of(scene), "scale"));
}

TEST(SceneTraps, T08MirroredCameraFlipsHandedness) {
    const std::string view = "LookAt 0 0 -4  0 0 0  0 1 0\nCamera \"perspective\"";
    const auto plain = read_options(view), mirrored = read_options("Scale -1 1 1\n" + view);
    const auto right = [](const SceneDescription& s) {
        return s.camera.camera_to_world.start().vector({1, 0, 0});
    };
    expect_near(right(plain), {1, 0, 0}, 1e-6f);
    expect_near(right(mirrored), {-1, 0, 0}, 1e-6f);
    EXPECT_TRUE(mirrored.camera.camera_to_world.start().swaps_handedness());
}

TEST(SceneTraps, T08MirrorsTurnQuadricsInsideOutAndReverseOrientationTurnsThemBack) {
    const auto is_inside_out = [](const std::string& text) {
        const auto scene = read_world(text);
        return scene.shapes.at(0).reverse_orientation;
    };
    for (const std::string shape : {"sphere", "disk", "cylinder"}) {
        const std::string made = "Shape \"" + shape + "\"";
        EXPECT_TRUE(is_inside_out("Scale 1 1 -1\n" + made)) << shape;
        EXPECT_TRUE(is_inside_out("ReverseOrientation\n" + made)) << shape;
        EXPECT_FALSE(is_inside_out("ReverseOrientation Scale 1 1 -1\n" + made)) << shape;
        EXPECT_FALSE(is_inside_out("Scale -1 1 -1\n" + made)) << shape;
        const std::string lamp = "AreaLightSource \"diffuse\"\n" + made;
        EXPECT_FALSE(is_inside_out("Scale 1 1 -1\n" + lamp)) << shape;
        EXPECT_TRUE(is_inside_out("ReverseOrientation Scale 1 1 -1\n" + lamp)) << shape;
    }
    // Meshes carry their winding through the mirror.
    const std::string mesh =
        "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] "
        "\"integer indices\" [ 0 1 2 ]";
    EXPECT_FALSE(is_inside_out("Scale 1 1 -1\n" + mesh));
}

TEST(SceneTraps, T09AreaLightWithoutAShape) {
    const auto scene =
        read_world("AttributeBegin\nAreaLightSource \"diffuse\"\nAttributeEnd\nShape \"sphere\"");
    EXPECT_EQ(scene.shapes.at(0).area_light, -1);
    EXPECT_TRUE(contains(warnings_of(scene), "has no shape"));
}

TEST(SceneTraps, T10InvisibleLightByAlpha) {
    const auto scene = read_world("AreaLightSource \"diffuse\"\nShape \"disk\" \"float alpha\" 0");
    ASSERT_EQ(scene.shapes.size(), 1u);
    EXPECT_EQ(scene.shapes[0].area_light, 0);
    EXPECT_EQ(constant_value(scene, scene.shapes[0].alpha), Rgb(0));
}

TEST(SceneTraps, T11FileNamesWithBlanksParentFoldersAndOtherCase) {
    const TemporaryFolder folder;
    folder.write("my models/Part One.pbrt", "Shape \"sphere\"\n");
    const auto scene = read_pbrt(folder.write("scenes/scene.pbrt",
                                              "WorldBegin\n"
                                              "Include \"../my models/Part One.pbrt\"\n"
                                              "Include \"../My Models/part one.PBRT\"\n"));
    EXPECT_EQ(scene.shapes.size(), 2u);
}

TEST(SceneTraps, T12UnknownParametersAreNotFatal) {
    const auto scene = read_pbrt_string(R"(Film "rgb" "float scale" 2
WorldBegin
LightSource "infinite" "integer nsamples" 4
Shape "sphere")",
                                        "test.pbrt");
    EXPECT_EQ(scene.shapes.size(), 1u);
    EXPECT_TRUE(contains(warnings_of(scene), "scale"));
    EXPECT_TRUE(contains(warnings_of(scene), "nsamples"));
}

TEST(SceneTraps, T13ConductorIndicesAsColours) {
    const auto scene = read_world(
        R"(Material "conductor" "rgb eta" [ 0.2 0.9 1.1 ] "rgb k" [ 3.9 2.4 2.1 ]
Shape "sphere")");
    const auto& m =
        std::get<ConductorMaterial>(scene.materials.at(size_t(scene.shapes.at(0).material)).value);
    expect_near(constant_value(scene, m.eta), Rgb(0.2f, 0.9f, 1.1f), 1e-3f);
    EXPECT_GT(constant_value(scene, m.k).r, 2);
}

// Environment maps of both layouts are taken as given here; light_environment_test.cpp tests the
// layouts themselves.
TEST(SceneTraps, T14EnvironmentMapsOfBothLayouts) {
    const TemporaryFolder folder;
    folder.write("sky.pfm", "PF\n2 1\n-1\n" + std::string(24, '\0'));
    const auto scene = read_pbrt(folder.write(
        "scene.pbrt", "WorldBegin\nLightSource \"infinite\" \"string filename\" \"sky.pfm\"\n"));
    EXPECT_TRUE(std::get<InfiniteLight>(scene.lights.at(0).value).image);
}

TEST(SceneTraps, T15RoughnessIsRemappedUnlessTheFileSaysNo) {
    const auto scene = read_world(R"(Material "conductor" "float roughness" 0.1
Material "conductor" "float roughness" 0.1 "bool remaproughness" false
Shape "sphere")");
    std::vector<bool> remaps;
    for (const MaterialDescription& m : scene.materials)
        if (const auto* c = std::get_if<ConductorMaterial>(&m.value))
            remaps.push_back(c->remap_roughness);
    EXPECT_EQ(remaps, (std::vector<bool>{true, false}));
}

TEST(SceneTraps, T16ImageFiltersAreAccepted) {
    const TemporaryFolder folder;
    folder.write("x.png", "");
    const auto scene = read_pbrt(folder.write("scene.pbrt", R"(WorldBegin
Texture "a" "spectrum" "imagemap" "string filename" "x.png" "string filter" "trilinear"
Texture "b" "spectrum" "imagemap" "string filename" "x.png" "string filter" "ewa" "float maxanisotropy" 4
)"));
    size_t images = 0;
    for (const TextureDescription& t : scene.textures)
        images += std::holds_alternative<ImageTexture>(t.value);
    EXPECT_EQ(images, 2u);
    EXPECT_TRUE(scene.warnings.empty()) << warnings_of(scene);
}

TEST(SceneTraps, T17FileNameThatIsAllExtension) {
    const TemporaryFolder folder;
    folder.write("models/.pbrt", "Shape \"sphere\"\n");
    const auto scene =
        read_pbrt(folder.write("scene.pbrt", "WorldBegin\nInclude \"models/.pbrt\"\n"));
    EXPECT_EQ(scene.shapes.size(), 1u);
}

TEST(SceneTraps, T18HugeInlineMesh) {
    constexpr int kTriangles = 200000;
    std::string indices, points;
    for (int i = 0; i < kTriangles; ++i) {
        for (int k = 0; k < 3; ++k) indices += std::to_string(3 * i + k) + " ";
        const std::string x = std::to_string(i) + ".25";
        points += x + " 0 0 " + x + " 1 0 " + x + " 0 1\n";
    }
    const auto scene = read_world("Shape \"trianglemesh\" \"integer indices\" [ " + indices +
                                  "]\n\"point3 P\" [ " + points + "]");
    const auto& mesh = *std::get<std::shared_ptr<const TriangleMesh>>(scene.shapes.at(0).geometry);
    EXPECT_EQ(mesh.triangles.size(), size_t(kTriangles));
    EXPECT_EQ(mesh.positions.back().x, float(kTriangles - 1) + 0.25f);
}

}  // namespace
}  // namespace covtrace
