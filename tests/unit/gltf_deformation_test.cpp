// Morph targets and skins of glTF files, and their motion over the shutter.
#include <algorithm>

#include "gltf/moving_pieces.h"
#include "gltf_fixtures.h"

namespace covtrace::test {
namespace {

constexpr int kSteps = 40;

/// A strip along x from 0 to 4 whose right half hangs on joint 1, with a smooth bend around x = 2.
/// Node 0: the mesh, moved aside, which counts for nothing; 1 and 2: the joints at x = 0 and 2.
GltfFile skinned_file() {
    GltfFile file;
    std::vector<float> points, weights;
    std::vector<uint8_t> joints;
    std::vector<uint16_t> indices;
    for (int i = 0; i <= kSteps; ++i)
        for (const float z : {0.0f, 1.0f}) {
            const float x = 4.0f * float(i) / kSteps;
            const float second = std::clamp(x - 1.5f, 0.0f, 1.0f);
            points.insert(points.end(), {x, 0, z});
            joints.insert(joints.end(), {0, 1, 0, 0});
            weights.insert(weights.end(), {1 - second, second, 0, 0});
        }
    for (uint16_t i = 0; i < kSteps; ++i)
        for (const int k : {0, 1, 2, 2, 1, 3}) indices.push_back(uint16_t(2 * i + k));
    const json attributes = {{"POSITION", file.add_floats(points, "VEC3", 3)},
                             {"JOINTS_0", file.add<uint8_t>(joints, 5121, "VEC4", 4)},
                             {"WEIGHTS_0", file.add_floats(weights, "VEC4", 4)}};
    file.root["meshes"] = {{{"primitives",
                             {{{"attributes", attributes},
                               {"indices", file.add<uint16_t>(indices, 5123, "SCALAR", 1)}}}}}};
    const int bind = file.add_floats({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0,  0, 0, 1,
                                      1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -2, 0, 0, 1},
                                     "MAT4", 16);
    file.root["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", bind}}};
    file.add_node({{"mesh", 0}, {"skin", 0}, {"translation", {100, 0, 0}}});
    file.add_node({{"children", {2}}, {"translation", {0, 0, 0}}});
    file.add_node({{"translation", {2, 0, 0}}});
    return file;
}

/// Turns joint 2 about z, by a right angle from time 0 to 1.
void animate(GltfFile& file) {
    const float h = std::sqrt(0.5f);
    const int times = file.add_floats({0, 1}, "SCALAR", 1);
    const int turns = file.add_floats({0, 0, 0, 1, 0, 0, h, h}, "VEC4", 4);
    file.root["animations"] = {
        {{"channels", {{{"sampler", 0}, {"target", {{"node", 2}, {"path", "rotation"}}}}}},
         {"samplers", {{{"input", times}, {"output", turns}}}}}};
}

/// The point (x, 0, z) after linear blend skinning with joint 2 turned by `angle`.
Vec3 skinned(float x, float z, float angle) {
    const float second = std::clamp(x - 1.5f, 0.0f, 1.0f);
    const Vec3 turned{2 + (x - 2) * std::cos(angle), (x - 2) * std::sin(angle), z};
    return Vec3{x, 0, z} * (1 - second) + turned * second;
}

TEST(GltfDeformation, JointsPlaceVertices) {
    GltfFile file = skinned_file();
    const float angle = 0.7f;
    file.root["nodes"][2]["rotation"] = {0, 0, std::sin(angle / 2), std::cos(angle / 2)};
    const auto scene = read(file);
    ASSERT_EQ(scene.shapes.size(), 1u);
    EXPECT_FALSE(scene.shapes[0].object_to_world.is_animated());
    const auto& positions = mesh_of(scene.shapes[0]).positions;
    ASSERT_EQ(positions.size(), 2u * (kSteps + 1));
    for (int i = 0; i <= kSteps; ++i)
        for (int k = 0; k < 2; ++k)
            expect_near(scene.shapes[0].object_to_world.start().point(positions[size_t(2 * i + k)]),
                        skinned(4.0f * float(i) / kSteps, float(k), angle), 1e-5f);
    EXPECT_EQ(all_warnings(scene).find("skin"), std::string::npos) << all_warnings(scene);
}

/// glTF 2.0, section 3.7.3.1: matrices that are not given are the identity.
TEST(GltfDeformation, JointsNeedNoInverseBindMatrices) {
    GltfFile file = skinned_file();
    file.root["skins"][0].erase("inverseBindMatrices");
    const SceneDescription scene = read(file);
    const TriangleMesh& mesh = mesh_of(scene.shapes[0]);
    // The second joint, at x = 2, carries the vertices of the end along.
    EXPECT_NEAR(mesh.positions.front().x, 0, 1e-6f);
    EXPECT_NEAR(mesh.positions.back().x, 6, 1e-6f);
}

TEST(GltfDeformation, WhatJointsBendMovesInPieces) {
    GltfFile file = skinned_file();
    animate(file);
    const auto scene = read(file, {{}, std::array<float, 2>{0, 0.5f}});
    ASSERT_GT(scene.shapes.size(), 2u);
    const float angle = 0.25f * 3.14159265f;
    const float way = length(skinned(4, 0, angle) - Vec3{4, 0, 0});
    size_t triangles = 0;
    for (const ShapeDescription& shape : scene.shapes) {
        const TriangleMesh& mesh = mesh_of(shape);
        triangles += mesh.triangles.size();
        for (const Vec3& p : mesh.positions) {
            const AnimatedTransform& t = shape.object_to_world;
            const Vec3 start = t.start().point(p), end = t.end().point(p);
            EXPECT_NEAR(start.y, 0, 1e-6f);  // as it is bound,
            EXPECT_LT(length(end - skinned(start.x, start.z, angle)),
                      1.01f * float(gltf::kLeft) * way)
                << p.x;
        }
    }
    EXPECT_EQ(triangles, 2u * kSteps);
    EXPECT_EQ(all_warnings(scene).find("bends"), std::string::npos) << all_warnings(scene);
}

TEST(GltfDeformation, WhatHangsOnOneJointMovesExactly) {
    GltfFile file = skinned_file();
    animate(file);
    // The whole strip hangs on the joint that turns.
    std::vector<float> weights;
    for (int i = 0; i < 2 * (kSteps + 1); ++i) weights.insert(weights.end(), {0, 3, 0, 0});
    file.root["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] =
        file.add_floats(weights, "VEC4", 4);
    const auto scene = read(file, {{}, std::array<float, 2>{0, 1}});
    ASSERT_EQ(scene.shapes.size(), 1u);
    const AnimatedTransform& t = scene.shapes[0].object_to_world;
    // The vertices move on arcs around the joint.
    const TriangleMesh& mesh = mesh_of(scene.shapes[0]);
    for (const float time : {0.0f, 0.5f, 1.0f}) {
        const float angle = 0.5f * 3.14159265f * time;
        for (const Vec3& p : mesh.positions) {
            const Vec3 rest = t.start().point(p), from_joint = rest - Vec3{2, 0, 0};
            expect_near(
                t.at(time).point(p),
                {2 + from_joint.x * std::cos(angle), from_joint.x * std::sin(angle), rest.z},
                1e-5f);
        }
    }
}

TEST(GltfDeformation, NormalsTurnWithTheirJoints) {
    GltfFile file = skinned_file();
    std::vector<float> normals;
    for (int i = 0; i < 2 * (kSteps + 1); ++i) normals.insert(normals.end(), {0, 1, 0});
    file.root["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] =
        file.add_floats(normals, "VEC3", 3);
    file.root["nodes"][2]["rotation"] = {0, 0, 1, 0};
    file.root["nodes"][2]["scale"] = {4, 1, 1};  // along the strip: the normal doesn't mind
    const auto scene = read(file);
    const TriangleMesh& mesh = mesh_of(scene.shapes.at(0));
    expect_near(mesh.normals.front(), {0, 1, 0}, 1e-6f);
    expect_near(mesh.normals.back(), {0, -1, 0}, 1e-6f);
}

/// The square, whose corners a first target lifts and a second one moves aside.
GltfFile morphing_file() {
    GltfFile file;
    file.add_node({{"mesh", file.add_square()}, {"translation", {0, 0, 10}}});
    const int up = file.add_floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3);
    const int aside = file.add_floats({1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC3", 3);
    file.root["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", up}},
                                                          {{"POSITION", aside}}};
    return file;
}

TEST(GltfDeformation, WeightsOfMeshesNodesAndAnimationsCount) {
    GltfFile file = morphing_file();
    const auto corner = [&](const ReadOptions& options = {}) {
        const auto scene = read(file, options);
        const ShapeDescription& shape = scene.shapes.at(0);
        return shape.object_to_world.start().point(mesh_of(shape).positions.at(0));
    };
    expect_near(corner(), {0, 0, 10}, 0);
    file.root["meshes"][0]["weights"] = {0.5, 0};
    expect_near(corner(), {0, 0, 10.5f}, 0);
    file.root["nodes"][0]["weights"] = {0.25, 2};
    expect_near(corner(), {2, 0, 10.25f}, 0);
    const int times = file.add_floats({0, 2}, "SCALAR", 1);
    const int values = file.add_floats({1, 1, 3, 1}, "SCALAR", 1);
    file.root["animations"] = {
        {{"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}},
         {"samplers", {{{"input", times}, {"output", values}}}}}};
    expect_near(corner(), {1, 0, 11}, 0);
    expect_near(corner({{}, std::array<float, 2>{1, 2}}), {1, 0, 12}, 0);
    const auto moving = read(file, {{}, std::array<float, 2>{0, 2}});
    const ShapeDescription& shape = moving.shapes.at(0);
    expect_near(shape.object_to_world.start().point(mesh_of(shape).positions.at(0)), {1, 0, 11},
                1e-6f);
    expect_near(shape.object_to_world.end().point(mesh_of(shape).positions.at(0)), {1, 0, 13},
                1e-6f);
}

TEST(GltfDeformation, MeshesAreSharedUnlessTheyDeform) {
    GltfFile file = morphing_file();
    file.add_node({{"mesh", 0}, {"weights", {1, 0}}});
    file.add_node({{"mesh", 0}});
    const auto scene = read(file);
    EXPECT_EQ(scene.instances.size(), 2u);
    ASSERT_EQ(scene.shapes.size(), 1u);
    EXPECT_EQ(mesh_of(scene.shapes[0]).positions.at(0).z, 1);
}

TEST(GltfDeformation, RefusesWhatDoesNotFit) {
    GltfFile file = skinned_file();
    file.root["skins"][0]["joints"] = {1};
    EXPECT_TRUE(contains(gltf_error(file), "nodes[0]: joint 1 is beyond the skin's 1 joints"));
    file.root["skins"][0]["joints"] = {1, 2, 0};
    EXPECT_TRUE(
        contains(gltf_error(file), "inverseBindMatrices: has 2 elements; expected at least 3"));
    file.root["skins"][0]["joints"] = {1, 9};
    EXPECT_TRUE(contains(gltf_error(file), "skins[0].joints[1]: there is no nodes[9]"));
    file = morphing_file();
    file.root["meshes"][0]["weights"] = {1, 1};
    file.root["meshes"][0]["primitives"][0]["targets"][1]["POSITION"] =
        file.add_floats({0, 0, 0}, "VEC3", 3);
    EXPECT_TRUE(contains(gltf_error(file), "targets[1].POSITION: has 1 elements; expected 4"));
    file = skinned_file();
    file.root["scenes"] = {{{"nodes", {0}}}};
    EXPECT_TRUE(contains(all_warnings(read(file)), "the joint is not in the scene"));
}

TEST(MovingPieces, FindTheMotionOfPointsInAPlaneAndInALine) {
    const Transform turn = Transform::translate({1, 2, 3}) * Transform::rotate(170, {1, 2, -1});
    const std::vector<std::vector<Vec3>> sets{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {3, 2, 1}},
                                              {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {3, 2, 0}},
                                              {{0, 0, 0}, {1, 0, 0}, {5, 0, 0}},
                                              {{1, 1, 1}}};
    for (const auto& start : sets) {
        std::vector<Vec3> end;
        for (const Vec3& p : start) end.push_back(turn.point(p));
        const auto found = Transform::from_matrix(gltf::nearest_motion(start, end));
        ASSERT_TRUE(found);
        EXPECT_FALSE(found->swaps_handedness());
        for (size_t i = 0; i < start.size(); ++i)
            expect_near(found->point(start[i]), end[i], 1e-5f);
    }
}

TEST(MovingPieces, StretchWhatIsStretched) {
    const std::vector<Vec3> start{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 0.5f}};
    std::vector<Vec3> end;
    for (const Vec3& p : start) end.push_back({3, 2 * p.x + 0.5f * p.y, p.y + 0.2f * p.z});
    for (size_t i = 0; i < end.size(); ++i) end[i].x += start[i].z;
    // The ridge keeps a few per cent of the stretch back.
    for (const size_t count : {size_t{4}, size_t{5}}) {  // flat, and with a body
        const auto m = gltf::nearest_motion({start.data(), count}, {end.data(), count});
        const auto found = Transform::from_matrix(m);
        ASSERT_TRUE(found);
        for (size_t i = 0; i < count; ++i) expect_near(found->point(start[i]), end[i], 0.1f);
    }
}

TEST(MovingPieces, BumpsOfFlatPiecesDoNotStretchThem) {
    std::vector<Vec3> start, end;
    for (int i = 0; i < 10; ++i)
        for (int j = 0; j < 10; ++j) {
            const float bump = (i + j) % 2 ? 0.01f : -0.01f;
            start.push_back({0.1f * float(i), 0.1f * float(j), bump});
            end.push_back({0.1f * float(i), 0.1f * float(j), 3 * bump});
        }
    EXPECT_NEAR(gltf::nearest_motion(start, end).m[2][2], 1, 0.2);
}

TEST(MovingPieces, SeparatePartsMoveAlone) {
    // The mesh is two squares whose halves share no vertex, as flat shading has them; one rests.
    std::vector<Vec3> start, end;
    std::vector<std::array<uint32_t, 3>> triangles;
    for (const float x : {0.0f, 10.0f})
        for (const auto& corners : {std::array{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{1, 1, 0}},
                                    std::array{Vec3{0, 0, 0}, Vec3{1, 1, 0}, Vec3{0, 1, 0}}}) {
            const auto i = static_cast<uint32_t>(start.size());
            triangles.push_back({i, i + 1, i + 2});
            for (const Vec3& p : corners) {
                start.push_back(p + Vec3{x, 0, 0});
                end.push_back(p + Vec3{x, 0, x});
            }
        }
    const auto cut = gltf::moving_pieces(start, end, triangles);
    ASSERT_EQ(cut.pieces.size(), 2u);
    EXPECT_LT(cut.left, 1e-6);
    EXPECT_EQ(cut.pieces[0].triangles, (std::vector<uint32_t>{0, 1}));
    EXPECT_EQ(cut.pieces[0].motion, Matrix4{});
    EXPECT_EQ(cut.pieces[1].triangles, (std::vector<uint32_t>{2, 3}));
    EXPECT_NEAR(cut.pieces[1].motion.m[2][3], 10, 1e-6);
}

TEST(MovingPieces, WhatOneTriangleCannotFollowIsTold) {
    // The triangle is flattened to a line.
    const std::vector<Vec3> start{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
        end{{0, 0, 0}, {1, 0, 0}, {1, 0, 0}};
    const std::vector<std::array<uint32_t, 3>> triangles{{0, 1, 2}};
    const auto cut = gltf::moving_pieces(start, end, triangles);
    EXPECT_EQ(cut.pieces.size(), 1u);
    EXPECT_GT(cut.left, 0.2);
}

}  // namespace
}  // namespace covtrace::test
