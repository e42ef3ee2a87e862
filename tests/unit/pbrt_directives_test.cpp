#include <zlib.h>

#include <cmath>

#include "pbrt_test_support.h"

namespace covtrace::test {
namespace {

Vec3 placed(const ShapeDescription& s, Vec3 p) {
    return s.object_to_world.start().point(p);
}

TEST(SceneDirectives, TransformsMultiplyFromTheRight) {
    const auto scene =
        read_world("Translate 1 2 3\nScale 2 2 2\nRotate 90 0 0 1\nShape \"sphere\"");
    expect_near(placed(scene.shapes.at(0), {1, 0, 0}), {1, 4, 3}, 1e-6f);
}

TEST(SceneDirectives, MatricesAreGivenByColumns) {
    const auto scene = read_world(
        "Transform [ 1 0 0 0  0 1 0 0  0 0 1 0  5 6 7 1 ]\nShape \"sphere\"\n"
        "ConcatTransform [ 2 0 0 0  0 2 0 0  0 0 2 0  1 0 0 1 ]\nShape \"sphere\"\n"
        "Identity\nShape \"sphere\"\n");
    expect_near(placed(scene.shapes.at(0), {1, 1, 1}), {6, 7, 8}, 0);
    expect_near(placed(scene.shapes.at(1), {1, 1, 1}), {8, 8, 9}, 0);
    expect_near(placed(scene.shapes.at(2), {1, 1, 1}), {1, 1, 1}, 0);
}

TEST(SceneDirectives, CameraIsTheInverseOfTheTransform) {
    const auto scene = read_options("LookAt 0 -5 0  0 0 0  0 0 1\nCamera \"perspective\"");
    const Transform& t = scene.camera.camera_to_world.start();
    expect_near(t.point({0, 0, 0}), {0, -5, 0}, 1e-6f);
    expect_near(t.vector({0, 0, 1}), {0, 1, 0}, 1e-6f);
    expect_near(t.vector({0, 1, 0}), {0, 0, 1}, 1e-6f);
}

TEST(SceneDirectives, ScaleBeforeLookAtMirrorsTheCamera) {
    const auto scene =
        read_options("Scale -1 1 1\nLookAt 0 0 0  0 0 1  0 1 0\nCamera \"perspective\"");
    EXPECT_TRUE(scene.camera.camera_to_world.start().swaps_handedness());
}

TEST(SceneDirectives, TheLastCameraCounts) {
    const auto scene = read_options(
        "Camera \"realistic\"\nTranslate 1 0 0\nCamera \"perspective\" \"float fov\" 25");
    EXPECT_EQ(scene.camera.fov, 25);
    expect_near(scene.camera.camera_to_world.start().point({}), {-1, 0, 0}, 0);
    EXPECT_TRUE(scene.warnings.empty()) << warnings_of(scene);
}

TEST(SceneDirectives, WorldBeginResetsTheTransformAndNamesCoordinateSystems) {
    const auto scene = read_pbrt_string(
        "Translate 0 0 5\nCamera \"perspective\"\nWorldBegin\nShape \"sphere\"\n"
        "Translate 9 0 0\nCoordinateSystem \"mine\"\nCoordSysTransform \"camera\"\nShape "
        "\"sphere\"\n"
        "CoordSysTransform \"mine\"\nShape \"sphere\"\nCoordSysTransform \"world\"\nShape "
        "\"sphere\"\n",
        "t.pbrt");
    expect_near(placed(scene.shapes.at(0), {}), {0, 0, 0}, 0);
    expect_near(placed(scene.shapes.at(1), {}), {0, 0, -5}, 0);
    expect_near(placed(scene.shapes.at(2), {}), {9, 0, 0}, 0);
    expect_near(placed(scene.shapes.at(3), {}), {0, 0, 0}, 0);
}

TEST(SceneDirectives, ActiveTransformMovesOneEnd) {
    const auto scene = read_pbrt_string(
        "TransformTimes 0.25 0.75\nWorldBegin\nActiveTransform StartTime\nTranslate 1 0 0\n"
        "ActiveTransform EndTime\nTranslate 2 0 0\nActiveTransform All\nTranslate 0 3 0\nShape "
        "\"sphere\"\n",
        "t.pbrt");
    const AnimatedTransform& t = scene.shapes.at(0).object_to_world;
    EXPECT_TRUE(t.is_animated());
    EXPECT_EQ(t.start_time(), 0.25f);
    EXPECT_EQ(t.end_time(), 0.75f);
    expect_near(t.at(0).point({}), {1, 3, 0}, 0);
    expect_near(t.at(1).point({}), {2, 3, 0}, 0);
    expect_near(t.at(0.5f).point({}), {1.5f, 3, 0}, 1e-6f);
}

TEST(SceneDirectives, CamerasMoveToo) {
    const auto scene =
        read_options("ActiveTransform EndTime Translate 0 0 -1\nCamera \"perspective\"");
    EXPECT_TRUE(scene.camera.camera_to_world.is_animated());
    expect_near(scene.camera.camera_to_world.end().point({}), {0, 0, 1}, 0);
}

TEST(SceneDirectives, BlocksRestoreEverything) {
    for (const std::string block : {"Attribute", "Transform"}) {
        const auto scene = read_world(
            "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_s\" [0 0 0]\n" +
            block +
            "Begin\nTranslate 1 0 0 ReverseOrientation\nMaterial \"conductor\"\n"
            "AreaLightSource \"diffuse\" MediumInterface \"fog\" \"\"\nShape \"sphere\"\n" +
            block + "End\nShape \"sphere\"\n");
        const ShapeDescription& in = scene.shapes.at(0);
        const ShapeDescription& out = scene.shapes.at(1);
        EXPECT_TRUE(in.reverse_orientation);
        EXPECT_EQ(in.area_light, 0);
        EXPECT_EQ(in.inside, 0);
        EXPECT_EQ(in.outside, -1);
        EXPECT_TRUE(
            std::holds_alternative<ConductorMaterial>(scene.materials[size_t(in.material)].value));
        expect_near(placed(in, {}), {1, 0, 0}, 0);
        EXPECT_FALSE(out.reverse_orientation);
        EXPECT_EQ(out.area_light, -1);
        EXPECT_EQ(out.inside, -1);
        EXPECT_TRUE(
            std::holds_alternative<DiffuseMaterial>(scene.materials[size_t(out.material)].value));
        expect_near(placed(out, {}), {0, 0, 0}, 0);
    }
}

TEST(SceneDirectives, ReverseOrientationToggles) {
    const auto scene = read_world("ReverseOrientation ReverseOrientation Shape \"sphere\"");
    EXPECT_FALSE(scene.shapes.at(0).reverse_orientation);
}

TEST(SceneDirectives, MediumInterfaceWithOneNameIsOnBothSides) {
    const auto scene = read_world(
        "MakeNamedMedium \"m\" \"string type\" \"homogeneous\"\n"
        "MediumInterface \"m\"\nShape \"sphere\"");
    EXPECT_EQ(scene.shapes.at(0).inside, 0);
    EXPECT_EQ(scene.shapes.at(0).outside, 0);
}

TEST(SceneDirectives, ObjectsKeepTheirTransformAndInstancesMultiplyTheirs) {
    const auto scene = read_world(
        "ObjectInstance \"o\"\n"  // used before it is defined
        "Translate 1 0 0\nObjectBegin \"o\"\nTranslate 0 2 0\nAreaLightSource \"diffuse\"\nShape "
        "\"sphere\"\n"
        "ObjectEnd\nTranslate 0 0 3\nObjectInstance \"o\"\nObjectInstance \"o\"\n");
    EXPECT_TRUE(scene.shapes.empty());
    ASSERT_EQ(scene.objects.size(), 1u);
    expect_near(placed(scene.objects[0].shapes.at(0), {}), {1, 2, 0}, 0);
    EXPECT_EQ(scene.objects[0].shapes[0].area_light, -1);
    ASSERT_EQ(scene.instances.size(), 3u);
    EXPECT_EQ(scene.instances[1].object, 0);
    expect_near(scene.instances[0].instance_to_world.start().point({}), {0, 0, 0}, 0);
    expect_near(scene.instances[1].instance_to_world.start().point({}), {1, 0, 3}, 0);
    EXPECT_TRUE(contains(warnings_of(scene), "area lights inside of objects are ignored"));
}

TEST(SceneDirectives, IncludesWorkInTheMiddleOfAParameterList) {
    const TemporaryFolder folder;
    folder.write("sub/head.pbrt", "Shape \"sphere\" \"float radius\" 4");
    folder.write("values.pbrt", "\"float zmin\" -1\n");
    folder.write("with blank.pbrt", "Shape \"disk\"\n");
    const auto main = folder.write("main.pbrt",
                                   "WorldBegin\nInclude \"sub/head.pbrt\" \"float phimax\" 90\n"
                                   "Include \"values.pbrt\" \"float zmax\" 2\n"
                                   "Include \"sub/../with blank.pbrt\"");
    const auto scene = read_pbrt(main);
    ASSERT_EQ(scene.shapes.size(), 2u);
    const auto& s = std::get<Sphere>(scene.shapes[0].geometry);
    EXPECT_EQ(s.radius, 4);
    EXPECT_EQ(s.phi_max, 90);
    EXPECT_EQ(s.z_min, -1);
    EXPECT_EQ(s.z_max, 2);
    EXPECT_TRUE(std::holds_alternative<Disk>(scene.shapes[1].geometry));
    EXPECT_EQ(scene.name, "main");
}

TEST(SceneDirectives, PlacesInIncludedFilesAreNamed) {
    const TemporaryFolder folder;
    const auto inner = folder.write("inner.pbrt", "\n  Shape \"teapot\"\n");
    const auto main = folder.write("main.pbrt", "WorldBegin\nInclude \"inner.pbrt\"\n");
    const Failure f = failure_of([&] { read_pbrt(main); });
    EXPECT_TRUE(
        f.message.starts_with(inner.string() + ":2:3: unknown shape \"teapot\"; expected one of"))
        << f.message;
}

TEST(SceneDirectives, CompressedFilesAreRead) {
    const TemporaryFolder folder;
    const auto compressed = folder.path() / "inner.pbrt.gz";
    const gzFile out = gzopen(compressed.c_str(), "wb");
    std::string text;
    for (int i = 0; i < 1000; ++i) text += "Shape \"sphere\"\n";
    gzwrite(out, text.data(), static_cast<unsigned>(text.size()));
    gzclose(out);
    const auto main = folder.write("main.pbrt", "WorldBegin Include \"inner.pbrt.gz\"");
    EXPECT_EQ(read_pbrt(main).shapes.size(), 1000u);
    std::filesystem::resize_file(compressed, std::filesystem::file_size(compressed) / 2);
    const Failure f = failure_of([&] { read_pbrt(main); });
    EXPECT_EQ(f.kind, ErrorKind::scene);
    EXPECT_TRUE(contains(f.message, "main.pbrt:1:20: can't decompress")) << f.message;
}

TEST(SceneDirectives, InclusionCannotGoOnForever) {
    const TemporaryFolder folder;
    const auto self = folder.write("self.pbrt", "Include \"self.pbrt\"");
    EXPECT_TRUE(contains(failure_of([&] { read_pbrt(self); }).message,
                         "self.pbrt:1:9: file \"self.pbrt\" includes itself"));
    const auto a = folder.write("a.pbrt", "WorldBegin Import \"sub/b.pbrt\"");
    folder.write("sub/b.pbrt", "Include \"sub/../a.pbrt\"");
    EXPECT_TRUE(contains(failure_of([&] { read_pbrt(a); }).message, "includes itself"));
    for (int i = 0; i < 70; ++i)
        folder.write(std::to_string(i) + ".pbrt", "Include \"" + std::to_string(i + 1) + ".pbrt\"");
    EXPECT_TRUE(contains(failure_of([&] { read_pbrt(folder.path() / "0.pbrt"); }).message,
                         "more than 64 deep"));
}

TEST(SceneDirectives, ImportLeavesTheStateAsItWas) {
    const TemporaryFolder folder;
    folder.write("part.pbrt",
                 "Shape \"sphere\" Translate 7 0 0 Material \"conductor\" Shape \"sphere\"\n"
                 "MakeNamedMaterial \"made inside\" \"string type\" \"diffuse\"");
    const auto main =
        folder.write("main.pbrt",
                     "WorldBegin Translate 1 0 0 Import \"part.pbrt\"\n"
                     "Shape \"sphere\" NamedMaterial \"made inside\" Shape \"sphere\"");
    const auto scene = read_pbrt(main);
    ASSERT_EQ(scene.shapes.size(), 4u);
    expect_near(placed(scene.shapes[0], {}), {1, 0, 0}, 0);
    expect_near(placed(scene.shapes[1], {}), {8, 0, 0}, 0);
    expect_near(placed(scene.shapes[2], {}), {1, 0, 0}, 0);
    EXPECT_EQ(scene.shapes[2].material, 0);
    folder.write("part.pbrt", "AttributeBegin");
    EXPECT_TRUE(contains(failure_of([&] { read_pbrt(main); }).message,
                         "part.pbrt:1:1: this block is not closed"));
}

TEST(SceneDirectives, FilesAreFoundInSpiteOfCaseAndBackslashes) {
    const TemporaryFolder folder;
    folder.write("Models/Part One.pbrt", "Shape \"sphere\"");
    const auto main = folder.write("main.pbrt", "WorldBegin\nInclude \"models\\\\part one.PBRT\"");
    const auto scene = read_pbrt(main);
    EXPECT_EQ(scene.shapes.size(), 1u);
    EXPECT_TRUE(contains(warnings_of(scene),
                         "2: file \"models\\part one.PBRT\" does not exist as written"));
    const TemporaryFolder other("other");
    const auto far = other.write("far/scene.pbrt", "WorldBegin\nInclude \"Part One.pbrt\"");
    EXPECT_TRUE(contains(failure_of([&] { read_pbrt(far); }).message,
                         "scene.pbrt:2:9: file \"Part One.pbrt\" not found"));
    EXPECT_EQ(read_pbrt(far, {.search_paths = {folder.path() / "Models"}}).shapes.size(), 1u);
}

TEST(SceneDirectives, OptionsAreAcceptedOrRefused) {
    const auto scene = read_options(
        "Option \"disablepixeljitter\" false\nOption \"seed\" 7\n"
        "Option \"disablewavelengthjitter\" true\n"
        "Option \"rendercoordsys\" \"world\"\nAccelerator \"bvh\"\n");
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_EQ(scene.warnings[0].text, "option \"seed\" is ignored");
    EXPECT_TRUE(
        contains(options_error("Option \"speed\" 7"), "test.pbrt:1:1: unknown option \"speed\""));
    EXPECT_TRUE(contains(options_error("Option \"integer seed\" 7"),
                         "test.pbrt:1:1: option \"integer seed\" has a type; expected its name "
                         "alone, \"seed\""));
}

TEST(SceneDirectives, TheHashFollowsEveryByteRead) {
    const TemporaryFolder folder;
    const auto part = folder.write("part.pbrt", "Shape \"sphere\"");
    const auto main = folder.write("main.pbrt", "WorldBegin Include \"part.pbrt\"");
    const uint64_t first = read_pbrt(main).content_hash;
    EXPECT_EQ(read_pbrt(main).content_hash, first);
    folder.write("part.pbrt", "Shape \"sphere\" ");
    EXPECT_NE(read_pbrt(main).content_hash, first);
}

}  // namespace
}  // namespace covtrace::test
