// Scenes that mean harm: each ends in an error, soon and without much memory.
#include <zlib.h>

#include <array>

#include "pbrt_test_support.h"

namespace covtrace::test {
namespace {

std::string include(const std::string& name) {
    return "Include \"" + name + "\"\n";
}

TEST(SceneHostile, FilesThatIncludeTwoOthersEach) {
    const TemporaryFolder folder;
    for (int i = 0; i < 40; ++i) {
        const std::string next = include(std::to_string(i + 1) + ".pbrt");
        folder.write(std::to_string(i) + ".pbrt", next + next);
    }
    folder.write("40.pbrt", std::string(1 << 16, '#') + "\n");
    const auto file = folder.write("scene.pbrt", "WorldBegin\n" + include("0.pbrt"));
    const Failure failure = failure_of([&] { read_pbrt(file); });
    EXPECT_EQ(failure.kind, ErrorKind::limit);
    EXPECT_TRUE(contains(failure.message, "again and again"));
}

TEST(SceneHostile, ACompressedBomb) {
    const TemporaryFolder folder;
    const auto bomb = (folder.path() / "bomb.pbrt.gz").string();
    // The file is 320 MiB of blanks in a third of a megabyte.
    gzFile out = gzopen(bomb.c_str(), "wb9");
    const std::string block(1 << 20, ' ');
    for (int i = 0; i < 320; ++i) gzwrite(out, block.data(), static_cast<unsigned>(block.size()));
    gzclose(out);
    const auto file = folder.write("scene.pbrt", "WorldBegin\n" + include("bomb.pbrt.gz"));
    const Failure failure = failure_of([&] { read_pbrt(file); });
    EXPECT_EQ(failure.kind, ErrorKind::limit);
    EXPECT_TRUE(contains(failure.message, "scene.pbrt:2:9: "));
    EXPECT_TRUE(contains(failure.message, "decompressed"));
}

TEST(SceneHostile, FilesOutsideOfTheScenesFolderAreTold) {
    const TemporaryFolder folder;
    folder.write("meshes/a.pbrt", "Shape \"sphere\"\n");
    folder.write("scenes/b.pbrt", "Shape \"sphere\"\n");
    const auto absolute = folder.path() / "meshes/a.pbrt";
    const auto file = folder.write(
        "scenes/scene.pbrt", "WorldBegin\n" + include("b.pbrt") + include("../scenes/b.pbrt") +
                                 include("../meshes/a.pbrt") + include(absolute.string()));
    const SceneDescription scene = read_pbrt(file);
    EXPECT_EQ(scene.shapes.size(), 4u);
    ASSERT_EQ(scene.warnings.size(), 1u) << warnings_of(scene);
    EXPECT_EQ(scene.warnings[0].where.line, 4);
    EXPECT_TRUE(contains(scene.warnings[0].text, "and in 1 more place"));
    EXPECT_TRUE(read_pbrt(file, {{folder.path() / "meshes"}}).warnings.empty());
}

TEST(SceneHostile, OfSeveralBrokenMeshesTheFirstIsNamed) {
    const TemporaryFolder folder;
    for (const char* name : {"a.ply", "b.ply", "c.ply"}) folder.write(name, "ply\n");
    const auto file = folder.write("scene.pbrt",
                                   "WorldBegin\n"
                                   "Shape \"plymesh\" \"string filename\" \"c.ply\"\n"
                                   "Shape \"plymesh\" \"string filename\" \"a.ply\"\n"
                                   "Shape \"plymesh\" \"string filename\" \"b.ply\"\n");
    for (int i = 0; i < 20; ++i)
        EXPECT_TRUE(contains(failure_of([&] { read_pbrt(file); }).message, "c.ply:2:1: "));
}

TEST(SceneHostile, MeshesKeepTheirPlaceAmongTheShapes) {
    const TemporaryFolder folder;
    folder.write("both.ply",
                 "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
                 "property float z\nelement face 2\nproperty list uchar int vertex_indices\n"
                 "end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n4 0 1 2 3\n");
    folder.write("none.ply",
                 "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n"
                 "property float z\nelement face 0\nproperty list uchar int vertex_indices\n"
                 "end_header\n");
    const auto scene = read_pbrt(folder.write("scene.pbrt",
                                              "WorldBegin\nShape \"sphere\"\n"
                                              "Shape \"plymesh\" \"string filename\" \"both.ply\"\n"
                                              "Shape \"plymesh\" \"string filename\" \"none.ply\"\n"
                                              "Shape \"disk\"\n"));
    ASSERT_EQ(scene.shapes.size(), 4u);
    const std::array<size_t, 4> kinds{2, 0, 1, 3};
    for (size_t i = 0; i < 4; ++i) EXPECT_EQ(scene.shapes[i].geometry.index(), kinds[i]) << i;
    EXPECT_TRUE(contains(warnings_of(scene), "4: the mesh file has no faces"));
}

}  // namespace
}  // namespace covtrace::test
