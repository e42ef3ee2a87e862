// Points and lines of glTF files as solids of about a pixel's width.
#include "gltf_fixtures.h"

namespace covtrace::test {
namespace {

/// Corners of a box of the diagonal 13, at (0, 0, 0), (3, 0, 0), (3, 4, 0), (3, 4, 12).
struct Marks {
    GltfFile file;
    int positions = file.add_floats({0, 0, 0, 3, 0, 0, 3, 4, 0, 3, 4, 12}, "VEC3", 3);

    SceneDescription of(int mode, const json& more = json::object(), double scale = 1) {
        json primitive = {{"attributes", {{"POSITION", positions}}}, {"mode", mode}};
        primitive.merge_patch(more);
        file.root["meshes"] = {{{"primitives", {primitive}}}};
        file.root["nodes"] = {{{"mesh", 0}, {"scale", {scale, scale, scale}}}};
        return read(file);
    }
};

/// Volume inside of a closed mesh whose triangles are turned outwards.
double volume(const TriangleMesh& mesh) {
    double sum = 0;
    for (const auto& triangle : mesh.triangles) {
        std::array<std::array<double, 3>, 3> p{};
        for (size_t i = 0; i < 3; ++i) {
            const Vec3 v = mesh.positions[triangle[i]];
            p[i] = {v.x, v.y, v.z};
        }
        for (size_t i = 0; i < 3; ++i) {
            const size_t k = (i + 1) % 3, l = (i + 2) % 3;
            sum += p[0][i] * (p[1][k] * p[2][l] - p[1][l] * p[2][k]) / 6;
        }
    }
    return sum;
}

TEST(GltfMarks, PointsAreTetrahedraOfAThousandthOfTheDiagonal) {
    Marks marks;
    const auto scene = marks.of(0);
    const TriangleMesh& mesh = mesh_of(scene.shapes.at(0));
    ASSERT_EQ(mesh.positions.size(), 4u * 4);
    const float radius = 1.5f * 0.5e-3f * 13;
    const Vec3 corners[] = {{0, 0, 0}, {3, 0, 0}, {3, 4, 0}, {3, 4, 12}};
    for (size_t i = 0; i < mesh.positions.size(); ++i)
        EXPECT_NEAR(distance(mesh.positions[i], corners[i / 4]), radius, 1e-5f) << i;
    EXPECT_EQ(mesh.triangles.size(), 4u * 4);
    EXPECT_NEAR(volume(mesh) / (4 * 8 * std::sqrt(3.0) / 27 * std::pow(double(radius), 3)), 1,
                0.02);
    EXPECT_EQ(scene.warnings.size(), 3u) << all_warnings(scene);  // no camera, no lights
    EXPECT_NE(
        all_warnings(scene).find("meshes[0].primitives[0]: points are shown as tetrahedra of a "
                                 "thousandth of the scene's diagonal, unlit, as they have no "
                                 "normals"),
        std::string::npos)
        << all_warnings(scene);
    // The node's scale changes nothing of their share of the whole.
    const auto large = marks.of(0, json::object(), 100);
    EXPECT_NEAR(distance(mesh_of(large.shapes.at(0)).positions[0], {0, 0, 0}), radius, 1e-5f);
}

TEST(GltfMarks, LinesAreRodsOfEveryMode) {
    Marks marks;
    const double area = 3 * std::sqrt(3.0) / 4 * std::pow(0.5e-3 * 13, 2);  // of a triangle
    // Pairs, a loop, a strip; the loop's last side is the diagonal.
    for (const auto& [mode, length] : {std::pair(1, 3 + 12), {2, 3 + 4 + 12 + 13}, {3, 3 + 4 + 12}})
        EXPECT_NEAR(volume(mesh_of(marks.of(mode).shapes.at(0))) / (area * length), 1, 1e-3)
            << mode;
    const int indices = marks.file.add<uint8_t>({0, 2, 1, 1}, 5121, "SCALAR", 1);
    const auto scene = marks.of(1, {{"indices", indices}});
    // A line from a point to itself is none.
    EXPECT_EQ(mesh_of(scene.shapes.at(0)).triangles.size(), 8u);
    EXPECT_NEAR(volume(mesh_of(scene.shapes[0])) / (area * 5), 1, 1e-3);
    EXPECT_EQ(scene.warnings.size(), 3u) << all_warnings(scene);  // no camera, no lights
    EXPECT_NE(all_warnings(scene).find("lines are shown as rods"), std::string::npos);
}

TEST(GltfMarks, AreUnlitWithoutNormalsAndKeepTheirColours) {
    Marks marks;
    marks.file.root["materials"] = {
        {{"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 1, 1, 1}}}}}};
    const int colours = marks.file.add_floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 0}, "VEC3", 3);
    const auto scene = marks.of(0, {{"material", 0}, {"attributes", {{"COLOR_0", colours}}}});
    const auto& unlit = model_of<UnlitMaterial>(scene, scene.shapes.at(0).material);
    const auto& product = constant_as<ScaleTexture>(scene, unlit.colour);
    expect_near(constant_value(scene, product.tex), {0.5f, 1, 1}, 0);
    const TriangleMesh& mesh = mesh_of(scene.shapes[0]);
    ASSERT_EQ(mesh.colours.size(), 16u);
    for (size_t i = 4; i < 8; ++i) expect_near(mesh.colours[i].value, {0, 1, 0}, 0);
    const int up = marks.file.add_floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3);
    const auto lit = marks.of(0, {{"material", 0}, {"attributes", {{"NORMAL", up}}}});
    EXPECT_NO_THROW(model_of<ConductorMaterial>(lit, lit.shapes.at(0).material));
    EXPECT_EQ(mesh_of(lit.shapes[0]).normals.at(15), (Vec3{0, 0, 1}));
    EXPECT_EQ(all_warnings(lit).find("unlit"), std::string::npos) << all_warnings(lit);
}

TEST(GltfMarks, MoveWithTheirMorphTargets) {
    Marks marks;
    const int moved = marks.file.add_floats({0, 0, 5, 0, 0, 5, 0, 0, 5, 0, 0, 5}, "VEC3", 3);
    const auto scene = marks.of(0, {{"targets", {{{"POSITION", moved}}}}});
    json& mesh = marks.file.root["meshes"][0];
    mesh["weights"] = {1};
    const auto after = read(marks.file);
    const TriangleMesh &rest = mesh_of(scene.shapes.at(0)), &end = mesh_of(after.shapes.at(0));
    ASSERT_EQ(rest.positions.size(), end.positions.size());
    for (size_t i = 0; i < rest.positions.size(); ++i)
        EXPECT_NEAR(distance(end.positions[i], rest.positions[i] + Vec3{0, 0, 5}), 0, 1e-5f);
}

TEST(GltfMarks, APointAloneIsSeen) {
    GltfFile file;
    const int place = file.add_floats({7, 8, 9}, "VEC3", 3);
    file.root["meshes"] = {
        {{"primitives", {{{"attributes", {{"POSITION", place}}}, {"mode", 0}}}}}};
    file.add_node({{"mesh", 0}});
    const auto scene = read(file);
    EXPECT_NEAR(distance(mesh_of(scene.shapes.at(0)).positions[0], {7, 8, 9}), 0.75e-3f, 1e-5f);
}

}  // namespace
}  // namespace covtrace::test
