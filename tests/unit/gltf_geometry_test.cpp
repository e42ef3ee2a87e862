// Meshes, accessors and nodes of glTF files.
#include "gltf_fixtures.h"

namespace covtrace::test {
namespace {

TEST(GltfGeometry, ReadsTextAndBinary) {
    const TemporaryFolder folder;
    const GltfFile file = square_file();
    const auto text = read_gltf(folder.write("a.gltf", file.text()));
    const auto binary = read_gltf(folder.write("b.GLB", file.binary()));
    for (const auto* scene : {&text, &binary}) {
        ASSERT_EQ(scene->shapes.size(), 1u);
        const TriangleMesh& mesh = mesh_of(scene->shapes[0]);
        ASSERT_EQ(mesh.positions.size(), 4u);
        expect_near(mesh.positions[2], {1, 1, 0}, 0);
        ASSERT_EQ(mesh.triangles.size(), 2u);
        EXPECT_EQ(mesh.triangles[1], (std::array<uint32_t, 3>{0, 2, 3}));
        // v runs upwards: the first corner is the image's lower left one.
        EXPECT_EQ(mesh.uvs[0].y, 0);
        EXPECT_EQ(mesh.uvs[3].y, 1);
    }
    EXPECT_EQ(text.name, "a");
}

TEST(GltfGeometry, ReadsStripsFansAndAllTypesOfIndices) {
    GltfFile file;
    const int p = file.add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0}, "VEC3", 3);
    const auto primitive = [&](int mode, int indices) {
        json j = {{"attributes", {{"POSITION", p}}}, {"mode", mode}};
        if (indices >= 0) j["indices"] = indices;
        return j;
    };
    const int bytes = file.add<uint8_t>({0, 1, 2, 3, 4}, 5121, "SCALAR", 1);
    const int ints = file.add<uint32_t>({4, 3, 2, 1, 0}, 5125, "SCALAR", 1);
    file.root["meshes"] = {
        {{"primitives", {primitive(5, bytes), primitive(6, ints), primitive(5, -1)}}}};
    file.add_node({{"mesh", 0}});
    const auto scene = read(file);
    ASSERT_EQ(scene.shapes.size(), 3u);
    using Triangles = std::vector<std::array<uint32_t, 3>>;
    EXPECT_EQ(mesh_of(scene.shapes[0]).triangles, (Triangles{{0, 1, 2}, {1, 3, 2}, {2, 3, 4}}));
    EXPECT_EQ(mesh_of(scene.shapes[1]).triangles, (Triangles{{3, 2, 4}, {2, 1, 4}, {1, 0, 4}}));
    EXPECT_EQ(mesh_of(scene.shapes[2]).triangles, mesh_of(scene.shapes[0]).triangles);
}

TEST(GltfGeometry, ReadsNormalisedStridedAndSparseAccessors) {
    GltfFile file;
    // Shorts at a stride of 8 bytes, as KHR_mesh_quantization has them.
    const std::vector<int16_t> shorts{0, 0, 0, 99, 32767, 0, 0, 99, 0, -32767, 0, 99};
    std::string bytes(shorts.size() * 2, '\0');
    std::memcpy(bytes.data(), shorts.data(), bytes.size());
    const int view = file.add_view(bytes, 8);
    const int index_view = file.add_view(std::string("\2\0", 2));
    const float moved[3] = {0, 0, 5};
    const int value_view = file.add_view({reinterpret_cast<const char*>(moved), sizeof moved});
    file.root["accessors"] = {{{"bufferView", view},
                               {"componentType", 5122},
                               {"count", 3},
                               {"type", "VEC3"},
                               {"normalized", true}},
                              {{"componentType", 5126},
                               {"count", 3},
                               {"type", "VEC3"},
                               {"sparse",
                                {{"count", 1},
                                 {"indices", {{"bufferView", index_view}, {"componentType", 5123}}},
                                 {"values", {{"bufferView", value_view}}}}}}};
    file.root["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", 0}, {"NORMAL", 1}}}}}}}};
    file.root["extensionsRequired"] = {"KHR_mesh_quantization"};
    file.add_node({{"mesh", 0}});
    const auto scene = read(file);
    const TriangleMesh& mesh = mesh_of(scene.shapes.at(0));
    expect_near(mesh.positions[1], {1, 0, 0}, 0);
    expect_near(mesh.positions[2], {0, -1, 0}, 0);
    expect_near(mesh.normals[0], {0, 0, 0}, 0);
    expect_near(mesh.normals[2], {0, 0, 5}, 0);
}

TEST(GltfGeometry, NormalsThatAreNotFiniteAreTheTriangles) {
    GltfFile file;
    const float nan = std::nanf("");
    const int position = file.add_floats({0, 0, 0, 2, 0, 0, 0, 0, 2, 9, 9, 9}, "VEC3", 3);
    const int normal =
        file.add_floats({nan, nan, nan, 0, 0, 3, 0, nan, 1, 1, INFINITY, 0}, "VEC3", 3);
    const int corners = file.add<uint8_t>({0, 1, 2}, 5121, "SCALAR", 1);
    file.root["meshes"] = {
        {{"primitives",
          {{{"attributes", {{"POSITION", position}, {"NORMAL", normal}}}, {"indices", corners}}}}}};
    file.add_node({{"mesh", 0}});
    const auto scene = read(file);
    const TriangleMesh& mesh = mesh_of(scene.shapes.at(0));
    expect_near(mesh.normals.at(0), {0, -1, 0}, 1e-6f);
    expect_near(mesh.normals.at(1), {0, 0, 3}, 0);
    expect_near(mesh.normals.at(2), {0, -1, 0}, 1e-6f);
    expect_near(mesh.normals.at(3), {0, 0, 1}, 0);  // of no triangle
    EXPECT_NE(all_warnings(scene).find("meshes[0].primitives[0].attributes.NORMAL: normals that "
                                       "are not finite"),
              std::string::npos)
        << all_warnings(scene);
}

TEST(GltfGeometry, NormalsThatSparseAccessorsMakeFiniteStay) {
    GltfFile file;
    const float nan = std::nanf("");
    const int position = file.add_floats({0, 0, 0, 2, 0, 0, 0, 0, 2}, "VEC3", 3);
    const int normal = file.add_floats({0, 0, 1, nan, nan, nan, 0, 0, 1}, "VEC3", 3);
    const int index_view = file.add_view(std::string("\1\0\2\0", 4));
    const float replaced[6] = {0, 0, 5, nan, 0, 0};
    const int value_view =
        file.add_view({reinterpret_cast<const char*>(replaced), sizeof replaced});
    file.root["accessors"][size_t(normal)]["sparse"] = {
        {"count", 2},
        {"indices", {{"bufferView", index_view}, {"componentType", 5123}}},
        {"values", {{"bufferView", value_view}}}};
    file.root["meshes"] = {
        {{"primitives", {{{"attributes", {{"POSITION", position}, {"NORMAL", normal}}}}}}}};
    file.add_node({{"mesh", 0}});
    const auto scene = read(file);
    const TriangleMesh& mesh = mesh_of(scene.shapes.at(0));
    expect_near(mesh.normals.at(0), {0, 0, 1}, 0);
    expect_near(mesh.normals.at(1), {0, 0, 5}, 0);
    expect_near(mesh.normals.at(2), {0, -1, 0}, 1e-6f);
}

TEST(GltfGeometry, NormalsOfPointsThatAreNotFiniteAreOfTheirSolids) {
    GltfFile file;
    const float nan = std::nanf("");
    const int position = file.add_floats({0, 0, 0, 2, 0, 0}, "VEC3", 3);
    const int normal = file.add_floats({nan, nan, nan, 0, 0, 3}, "VEC3", 3);
    file.root["meshes"] = {
        {{"primitives",
          {{{"attributes", {{"POSITION", position}, {"NORMAL", normal}}}, {"mode", 0}}}}}};
    file.add_node({{"mesh", 0}});
    const auto scene = read(file);
    const TriangleMesh& mesh = mesh_of(scene.shapes.at(0));
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
    int of_first = 0;
    for (size_t i = 0; i < mesh.positions.size(); ++i)
        if (const Vec3 p = mesh.positions[i]; p.x < 1) {
            EXPECT_NEAR(length(mesh.normals[i]), 1, 1e-5f);
            EXPECT_NEAR(dot(mesh.normals[i], p) / length(p), 1, 1e-4f);
            ++of_first;
        } else {
            expect_near(mesh.normals[i], {0, 0, 3}, 0);
        }
    EXPECT_GT(of_first, 0);
}

TEST(GltfGeometry, KeepsTheVerticesThatTrianglesUse) {
    // A hundred squares that pick their corners from the vertices of all of them.
    GltfFile file;
    std::vector<float> points, uvs;
    constexpr uint32_t kSquares = 100;
    for (uint32_t i = 0; i < kSquares; ++i)
        for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
            points.insert(points.end(), {float(i) + float(x), float(y), 0});
            uvs.insert(uvs.end(), {float(i), float(y)});
        }
    const int position = file.add_floats(points, "VEC3", 3), uv = file.add_floats(uvs, "VEC2", 2);
    json primitives = json::array();
    for (uint32_t i = 0; i < kSquares; ++i) {
        const uint32_t v = 4 * i;
        const int indices =
            file.add<uint32_t>({v + 3, v, v + 1, v + 3, v + 1, v + 2}, 5125, "SCALAR", 1);
        primitives.push_back(
            {{"attributes", {{"POSITION", position}, {"TEXCOORD_0", uv}}}, {"indices", indices}});
    }
    file.root["meshes"] = {{{"primitives", primitives}}};
    file.add_node({{"mesh", 0}});
    const SceneDescription scene = read(file);
    ASSERT_EQ(scene.shapes.size(), kSquares);
    for (uint32_t i = 0; i < kSquares; ++i) {
        const TriangleMesh& mesh = mesh_of(scene.shapes[i]);
        ASSERT_EQ(mesh.positions.size(), 4u);
        ASSERT_EQ(mesh.uvs.size(), 4u);
        const auto& t = mesh.triangles.at(0);
        EXPECT_EQ(mesh.positions[t[0]], (Vec3{float(i), 1, 0}));
        EXPECT_EQ(mesh.positions[t[1]], (Vec3{float(i), 0, 0}));
        EXPECT_EQ(mesh.positions[t[2]], (Vec3{float(i) + 1, 0, 0}));
        EXPECT_EQ(mesh.uvs[t[2]].x, float(i));
    }
}

TEST(GltfGeometry, ReadsAMeshOnceForAllItsNodes) {
    // Visits of 20 000 vertices by 20 000 nodes would take seconds; lights are as many as shapes.
    GltfFile file;
    std::vector<float> points;
    for (int i = 0; i < 20'000; ++i) points.insert(points.end(), {float(i % 7), float(i % 5), 0});
    const int position = file.add_floats(points, "VEC3", 3);
    file.root["materials"] = {{{"emissiveFactor", {1, 1, 1}}}};
    const json dark = {{"attributes", {{"POSITION", position}}}};
    json shining = dark;
    shining["material"] = 0;
    file.root["meshes"] = {{{"primitives", {dark, shining}}}};
    constexpr size_t kNodes = 20'000;
    for (size_t i = 0; i < kNodes; ++i)
        file.add_node({{"mesh", 0}, {"translation", {float(i), 0, 0}}});
    const SceneDescription scene = read(file);
    EXPECT_EQ(scene.instances.size(), kNodes);
    EXPECT_EQ(scene.objects.size(), 1u);
    EXPECT_EQ(scene.shapes.size(), kNodes);
    EXPECT_EQ(scene.area_lights.size(), kNodes);
    EXPECT_EQ(scene.shapes[7].area_light, 7);
}

TEST(GltfGeometry, PlacesNodesByTheirParents) {
    GltfFile file;
    const int square = file.add_square();
    const double h = std::sqrt(0.5);
    file.add_node({{"children", {1}}, {"translation", {1, 2, 3}}, {"rotation", {0, 0, h, h}}});
    file.add_node({{"mesh", square}, {"scale", {2, 2, 2}}, {"children", {2}}});
    file.add_node({{"mesh", square}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 1}}});
    file.root["scenes"] = {{{"nodes", {0}}}};
    const auto scene = read(file);
    // The mesh is shared, so it is an object.
    ASSERT_EQ(scene.instances.size(), 2u);
    EXPECT_TRUE(scene.shapes.empty());
    ASSERT_EQ(scene.objects.size(), 1u);
    expect_near(scene.instances[0].instance_to_world.start().point({1, 0, 0}), {1, 4, 3}, 1e-6f);
    expect_near(scene.instances[1].instance_to_world.start().point({0, 0, 0}), {1, 2, 5}, 1e-6f);
}

TEST(GltfGeometry, PlacesListedNodesThatAreNoRootsOnce) {
    // Nodes 0 to 2 hang below each other, each one step along x from its parent.
    GltfFile file;
    file.add_node({{"translation", {1, 0, 0}}, {"children", {1}}, {"mesh", file.add_square()}});
    file.add_node({{"translation", {1, 0, 0}}, {"children", {2}}, {"mesh", file.add_square()}});
    file.add_node({{"translation", {1, 0, 0}}, {"mesh", file.add_square()}});
    const auto places = [&](const json& listed, const std::string& warning) {
        file.root["scenes"] = {{{"nodes", listed}}};
        const SceneDescription scene = read(file);
        EXPECT_TRUE(contains(all_warnings(scene), warning)) << all_warnings(scene);
        EXPECT_TRUE(scene.instances.empty());
        std::vector<float> x;
        for (const ShapeDescription& shape : scene.shapes)
            x.push_back(shape.object_to_world.start().point({0, 0, 0}).x);
        return x;
    };
    using Places = std::vector<float>;
    const std::string below = "2 of its 3 nodes are no roots but below others of it";
    EXPECT_EQ(places({0, 1, 2}, below), (Places{1, 2, 3}));
    EXPECT_EQ(places({2, 1, 0}, below), (Places{1, 2, 3}));
    EXPECT_EQ(places({0, 2}, "1 of its 2 nodes are no roots but below"), (Places{1, 2, 3}));
    EXPECT_EQ(places({0, 0}, "no camera"), (Places{1, 2, 3}));
    // Parents that are not in the scene move nothing.
    EXPECT_EQ(places({1}, "1 of its 1 nodes are no roots, and their parents"), (Places{1, 2}));
    EXPECT_EQ(places({1, 2}, "1 of its 2 nodes are no roots, and their parents"), (Places{1, 2}));
}

TEST(GltfGeometry, MovesNodesOverTheShutter) {
    GltfFile file;
    file.add_node({{"mesh", file.add_square()}, {"children", {1}}});
    file.add_node({{"mesh", file.add_square()}});
    const int times = file.add_floats({1, 3}, "SCALAR", 1);
    const int places = file.add_floats({0, 0, 0, 8, 0, 0}, "VEC3", 3);
    // The sampler is cubic: in-tangent, value, out-tangent per key.
    const int cubic =
        file.add_floats({0, 0, 0, 1, 1, 1, 0, 0, 0, 0, 0, 0, 3, 3, 3, 0, 0, 0}, "VEC3", 3);
    file.root["animations"] = {
        {{"channels",
          {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}},
           {{"sampler", 1}, {"target", {{"node", 1}, {"path", "scale"}}}}}},
         {"samplers",
          {{{"input", times}, {"output", places}},
           {{"input", times}, {"output", cubic}, {"interpolation", "CUBICSPLINE"}}}}}};
    const auto moving = read(file, {{}, std::array<float, 2>{1.5f, 2.5f}});
    ASSERT_EQ(moving.shapes.size(), 2u);
    const AnimatedTransform& first = moving.shapes[0].object_to_world;
    EXPECT_EQ(first.start_time(), 1.5f);
    expect_near(first.start().point({0, 0, 0}), {2, 0, 0}, 1e-5f);
    expect_near(first.end().point({0, 0, 0}), {6, 0, 0}, 1e-5f);
    EXPECT_EQ(moving.camera.shutter_open, 1.5f);
    // The place at u = 1/4 is 1 + 2 (3 u^2 - 2 u^3), upon the parent's place.
    expect_near(moving.shapes[1].object_to_world.start().point({1, 0, 0}), {3.3125f, 0, 0}, 1e-5f);
    // The exposure changes the blur, not the brightness.
    EXPECT_NEAR((moving.camera.shutter_close - moving.camera.shutter_open) * moving.film.iso, 100,
                1e-3);

    const auto still = read(file);
    EXPECT_FALSE(still.shapes[0].object_to_world.is_animated());
    EXPECT_TRUE(contains(all_warnings(still), "a shutter from T0 to T1"));

    file.root["animations"][0]["samplers"][0]["interpolation"] = "STEP";
    const auto step = read(file, {{}, std::array<float, 2>{2.9f, 3}});
    expect_near(step.shapes[0].object_to_world.start().point({0, 0, 0}), {0, 0, 0}, 0);
    expect_near(step.shapes[0].object_to_world.end().point({0, 0, 0}), {8, 0, 0}, 0);
}

TEST(GltfGeometry, LeavesOutAnimationsOfOtherThanNodes) {
    GltfFile file = square_file();
    const int times = file.add_floats({0, 1}, "SCALAR", 1);
    const int values = file.add_floats({0, 1}, "SCALAR", 1);
    const json pointer = {{"ACME_pointer", {{"pointer", "/materials/0/alphaCutoff"}}}};
    file.root["animations"] = {
        {{"channels",
          {{{"sampler", 0}, {"target", {{"path", "pointer"}, {"extensions", pointer}}}}}},
         {"samplers", {{{"input", times}, {"output", values}}}}}};
    EXPECT_TRUE(contains(all_warnings(read(file)),
                         "animations[0].channels[0]: extension ACME_pointer is left out"));
    // One that names neither a node nor an extension is to be ignored.
    file.root["animations"][0]["channels"][0]["target"] = {{"path", "translation"}};
    EXPECT_FALSE(contains(all_warnings(read(file)), "animations[0]"));
}

TEST(GltfGeometry, ReadsScenesWithoutTriangles) {
    GltfFile spot = square_file();
    spot.root["accessors"][2]["count"] = 2;  // of the indices
    GltfFile empty;
    empty.add_node({{"name", "nothing"}});
    for (const GltfFile& file : {spot, empty}) {
        const SceneDescription scene = read(file);
        EXPECT_TRUE(scene.shapes.empty() && scene.instances.empty());
        EXPECT_TRUE(is_finite(scene.camera.camera_to_world.start().point({0, 0, 0})));
    }
}

TEST(GltfGeometry, HidesWhatIsNotVisible) {
    GltfFile file;
    const int mesh = file.add_square();
    const json hidden = {{"KHR_node_visibility", {{"visible", false}}}},
               shown = {{"KHR_node_visibility", {{"visible", true}}}};
    file.add_node({{"mesh", mesh}, {"children", {2}}, {"extensions", hidden}});
    file.add_node({{"mesh", mesh}, {"translation", {7, 0, 0}}, {"extensions", shown}});
    file.add_node({{"mesh", mesh}, {"extensions", shown}});  // below the hidden one
    file.root["scenes"] = {{{"nodes", {0, 1}}}};
    const auto scene = read(file);
    ASSERT_EQ(scene.shapes.size() + scene.instances.size(), 1u);
    expect_near(scene.shapes[0].object_to_world.start().point({0, 0, 0}), {7, 0, 0}, 0);
    EXPECT_FALSE(contains(all_warnings(scene), "KHR_node_visibility"));
}

TEST(GltfGeometry, CopiesMeshesAsInstancingSays) {
    GltfFile file = square_file();
    const float h = std::sqrt(0.5f);
    const json attributes = {
        {"TRANSLATION", file.add_floats({1, 0, 0, 0, 2, 0, 0, 0, 3}, "VEC3", 3)},
        {"ROTATION", file.add_floats({0, 0, 0, 1, 0, 0, h, h, 0, 0, 0, 1}, "VEC4", 4)},
        {"SCALE", file.add_floats({1, 1, 1, 2, 2, 2, 0, 0, 0}, "VEC3", 3)}};
    file.root["nodes"][0]["translation"] = {10, 0, 0};
    file.root["nodes"][0]["extensions"] = {
        {"EXT_mesh_gpu_instancing", {{"attributes", attributes}}}};
    const auto scene = read(file);
    // The third one has no size.
    ASSERT_EQ(scene.instances.size(), 2u);
    ASSERT_EQ(scene.objects.size(), 1u);
    const auto point = [&](size_t i, Vec3 p) {
        return scene.instances[i].instance_to_world.start().point(p);
    };
    expect_near(point(0, {0.5f, 0, 0}), {11.5f, 0, 0}, 1e-6f);
    // Twice as large, turned from x to y, then two upwards.
    expect_near(point(1, {0.5f, 0, 0}), {10, 3, 0}, 1e-5f);
    file.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["SCALE"] =
        file.add_floats({1, 1, 1}, "VEC3", 3);
    EXPECT_TRUE(contains(failure_of([&] { read(file); }).message,
                         "attributes.SCALE: has 1 elements; expected 3"));
}

TEST(GltfGeometry, LimitsTheCopiesOfASmallFile) {
    GltfFile file;
    const int mesh = file.add_square();
    const std::vector<float> places(3 * 20000);
    const json copies = {{"EXT_mesh_gpu_instancing",
                          {{"attributes", {{"TRANSLATION", file.add_floats(places, "VEC3", 3)}}}}}};
    for (int i = 0; i < 1000; ++i) file.add_node({{"mesh", mesh}, {"extensions", copies}});
    const Failure failure = failure_of([&] { read(file); });
    EXPECT_TRUE(contains(failure.message, "the copies of meshes are too many"));
}

TEST(GltfGeometry, HidesWhatHasNoSize) {
    GltfFile file = square_file();
    file.add_node({{"mesh", 0}, {"scale", {0, 0, 0}}});
    const auto scene = read(file);
    EXPECT_TRUE(contains(all_warnings(scene), "nodes[1]: a scale of zero hides"));
}

}  // namespace
}  // namespace covtrace::test
