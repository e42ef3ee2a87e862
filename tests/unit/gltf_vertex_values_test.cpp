// Colours and texture coordinates of glTF's vertices.
#include "gltf_fixtures.h"

namespace covtrace::test {
namespace {

/// The square with colours, and one material.
struct ColouredSquare {
    GltfFile file;
    explicit ColouredSquare(const json& material = json::object()) {
        file.add_node({{"mesh", file.add_square({{"material", 0}})}});
        file.root["materials"] = json::array({material});
    }
    json& attributes() { return file.root["meshes"][0]["primitives"][0]["attributes"]; }
    void set_colours(int accessor) { attributes()["COLOR_0"] = accessor; }
    /// Four colours with alpha, the third one half transparent and red.
    void set_rgba() {
        set_colours(file.add<uint8_t>({255, 255, 255, 255, 0, 255, 0, 255,  //
                                       255, 0, 0, 51, 255, 255, 255, 255},
                                      5121, "VEC4", 4, true));
    }
};

const json kDielectric = {{"metallicFactor", 0}, {"baseColorFactor", {0.5, 1, 1, 1}}};

TEST(GltfVertexColours, AreReadInAllTypes) {
    const auto colours = [](auto add) {
        ColouredSquare square;
        square.set_colours(add(square.file));
        const auto scene = read(square.file);
        EXPECT_EQ(all_warnings(scene).find("COLOR_0"), std::string::npos) << all_warnings(scene);
        return mesh_of(scene.shapes.at(0)).colours;
    };
    const auto floats = colours([](GltfFile& f) {
        return f.add_floats({1, 1, 1, 0, 0.25f, 3, -1, 0, 0, 1, 1, 1}, "VEC3", 3);
    });
    ASSERT_EQ(floats.size(), 4u);
    expect_near(floats[1].value, {0, 0.25f, 3}, 0);
    expect_near(floats[2].value, {0, 0, 0}, 0);
    EXPECT_EQ(floats[1].alpha, 1);
    for (const bool is_normalised : {true, false}) {
        const auto bytes = colours([&](GltfFile& f) {
            return f.add<uint8_t>({255, 51, 0, 102, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, 5121,
                                  "VEC4", 4, is_normalised);
        });
        expect_near(bytes[0].value, {1, 0.2f, 0}, 1e-6f);
        EXPECT_NEAR(bytes[0].alpha, 0.4f, 1e-6f);
    }
    const auto shorts = colours([](GltfFile& f) {
        return f.add<uint16_t>({65535, 13107, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, 5123, "VEC3", 3, true);
    });
    expect_near(shorts[0].value, {1, 0.2f, 0}, 1e-6f);
    // White changes nothing, so it is not kept.
    EXPECT_TRUE(colours([](GltfFile& f) {
                    return f.add_floats(std::vector<float>(16, 1), "VEC4", 4);
                }).empty());
}

TEST(GltfVertexColours, MultiplyTheBaseColour) {
    ColouredSquare square(json::object({{"pbrMetallicRoughness", kDielectric}}));
    square.set_rgba();
    const auto scene = read(square.file);
    const auto& base = model_of<CoatedDiffuseMaterial>(scene, scene.shapes[0].material);
    const auto& product = constant_as<ScaleTexture>(scene, base.reflectance);
    expect_near(constant_value(scene, product.tex), {0.5f, 1, 1}, 0);
    EXPECT_FALSE(constant_as<VertexColourTexture>(scene, product.scale).is_alpha);
    EXPECT_EQ(scene.shapes[0].alpha, -1);  // the material is opaque
    // The jump between both triangles is none: they share the corners of their common side.
    EXPECT_EQ(mesh_of(scene.shapes[0]).colour_steps,
              (std::vector<std::array<uint8_t, 3>>{{0, 0, 0}, {0, 0, 0}}));
    // A second primitive of the material without colours stays as it is.
    GltfFile two = square.file;
    two.add_node({{"mesh", two.add_square({{"material", 0}})}});
    const auto both = read(two);
    const auto& plain = model_of<CoatedDiffuseMaterial>(both, both.shapes.at(1).material);
    expect_near(constant_value(both, plain.reflectance), {0.5f, 1, 1}, 0);
    EXPECT_TRUE(mesh_of(both.shapes[1]).colours.empty());
}

TEST(GltfVertexColours, AlphaCountsByTheAlphaMode) {
    ColouredSquare blend({{"alphaMode", "BLEND"}, {"pbrMetallicRoughness", kDielectric}});
    blend.set_rgba();
    const auto blended = read(blend.file);
    EXPECT_TRUE(constant_as<VertexColourTexture>(blended, blended.shapes[0].alpha).is_alpha);
    json half = kDielectric;
    half["baseColorFactor"] = {1, 1, 1, 0.5};
    ColouredSquare mask(
        {{"alphaMode", "MASK"}, {"alphaCutoff", 0.25}, {"pbrMetallicRoughness", half}});
    mask.set_rgba();
    const auto masked = read(mask.file);
    const auto& cutoff = constant_as<CutoffTexture>(masked, masked.shapes[0].alpha);
    EXPECT_EQ(cutoff.cutoff, 0.25f);
    const auto& product = constant_as<ScaleTexture>(masked, cutoff.tex);
    EXPECT_EQ(constant_value(masked, product.tex).r, 0.5f);
    EXPECT_TRUE(constant_as<VertexColourTexture>(masked, product.scale).is_alpha);
}

TEST(GltfVertexColours, TintWhatIsUnlit) {
    ColouredSquare square({{"pbrMetallicRoughness", kDielectric},
                           {"extensions", {{"KHR_materials_unlit", json::object()}}}});
    square.set_rgba();
    const auto scene = read(square.file);
    const auto& unlit = model_of<UnlitMaterial>(scene, scene.shapes[0].material);
    const auto& product = constant_as<ScaleTexture>(scene, unlit.colour);
    expect_near(constant_value(scene, product.tex), {0.5f, 1, 1}, 0);
    EXPECT_FALSE(constant_as<VertexColourTexture>(scene, product.scale).is_alpha);
    EXPECT_EQ(scene.shapes[0].area_light, -1);
    EXPECT_FALSE(contains(all_warnings(scene), "KHR_materials_unlit"));
}

TEST(GltfVertexColours, StayWithTheVerticesOfPiecesAndPicks) {
    // A primitive that uses one of many squares, whose colours are the number of the vertex.
    GltfFile file;
    std::vector<float> points, colours, aside;
    std::vector<uint16_t> indices;
    constexpr int kSquares = 40;
    for (int i = 0; i < 4 * kSquares; ++i) {
        points.insert(points.end(), {float(i / 2), float(i % 2), 0});
        colours.insert(colours.end(), {float(i), 0, 0});
        // The halves move apart, each bending on its way.
        aside.insert(aside.end(), {i < 30 ? -9.0f : 9.0f, 0, float(i % 5)});
    }
    for (const int first : {8, 60})
        for (const int k : {0, 1, 2, 2, 1, 3}) indices.push_back(uint16_t(first + k));
    file.root["meshes"] = {
        {{"primitives",
          {{{"attributes",
             {{"POSITION", file.add_floats(points, "VEC3", 3)},
              {"COLOR_0", file.add_floats(colours, "VEC3", 3)}}},
            {"indices", file.add<uint16_t>(indices, 5123, "SCALAR", 1)},
            {"targets", {{{"POSITION", file.add_floats(aside, "VEC3", 3)}}}}}}}}};
    file.add_node({{"mesh", 0}});
    const int times = file.add_floats({0, 1}, "SCALAR", 1);
    const int weights = file.add_floats({0, 1}, "SCALAR", 1);
    file.root["animations"] = {
        {{"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}},
         {"samplers", {{{"input", times}, {"output", weights}}}}}};
    const auto check = [](const SceneDescription& scene) {
        size_t triangles = 0;
        for (const ShapeDescription& shape : scene.shapes) {
            const TriangleMesh& mesh = mesh_of(shape);
            ASSERT_EQ(mesh.colours.size(), mesh.positions.size());
            ASSERT_EQ(mesh.colour_steps.size(), mesh.triangles.size());
            triangles += mesh.triangles.size();
            for (size_t i = 0; i < mesh.positions.size(); ++i) {
                const Vec3 p = shape.object_to_world.start().point(mesh.positions[i]);
                EXPECT_NEAR(mesh.colours[i].value.r, 2 * p.x + p.y, 1e-4f);
            }
        }
        EXPECT_EQ(triangles, 4u);
    };
    check(read(file));
    const auto moving = read(file, {{}, std::array<float, 2>{0, 1}});
    EXPECT_GT(moving.shapes.size(), 1u);
    check(moving);
}

TEST(GltfTextureCoordinates, EachTextureHasItsOwnSet) {
    GltfFile file;
    file.root["images"] = {{{"bufferView", file.add_view("bytes")}, {"mimeType", "image/png"}}};
    file.root["textures"] = {{{"source", 0}}};
    const auto texture = [](int set) { return json{{"index", 0}, {"texCoord", set}}; };
    file.root["materials"] = {{{"pbrMetallicRoughness",
                                {{"baseColorTexture", texture(0)},
                                 {"metallicFactor", 0},
                                 {"metallicRoughnessTexture", texture(2)}}},
                               {"emissiveFactor", {1, 1, 1}},
                               {"emissiveTexture", texture(1)},
                               {"normalTexture", texture(1)}}};
    file.add_node({{"mesh", file.add_square({{"material", 0}})}});
    auto& attributes = file.root["meshes"][0]["primitives"][0]["attributes"];
    attributes["TEXCOORD_1"] = file.add_floats({1, 1, 2, 1, 2, 2, 1, 2}, "VEC2", 2);
    const auto scene = read(file);
    const ShapeDescription& shape = scene.shapes.at(0);
    // Tangents come from the set of the normal map, which is the surface's own.
    const TriangleMesh& mesh = mesh_of(shape);
    EXPECT_EQ(mesh.uvs.at(2).x, 2);
    EXPECT_EQ(mesh.uvs.at(2).y, 1 - 2);
    ASSERT_EQ(mesh.more_uvs.size(), 2u);
    EXPECT_EQ(mesh.more_uvs[0].at(2).x, 1);
    EXPECT_EQ(mesh.more_uvs[0].at(2).y, 1);
    EXPECT_TRUE(contains(all_warnings(scene), "has textures but no TEXCOORD_2"));
    const auto set_of = [&](TextureId id) {
        return constant_as<ImageTexture>(scene, id).mapping.uv_set;
    };
    const MaterialDescription& material = scene.materials.at(size_t(shape.material));
    EXPECT_EQ(set_of(material.normal_map), -1);
    EXPECT_EQ(set_of(scene.area_lights.at(0).image), -1);
    const auto& base = model_of<CoatedDiffuseMaterial>(scene, shape.material);
    EXPECT_EQ(set_of(base.reflectance), 0);
    EXPECT_EQ(set_of(constant_as<ScaleTexture>(scene, base.u_roughness).tex), 1);
    // Colours of vertices need coordinates that tell all points of a triangle apart, as its own do.
    attributes["COLOR_0"] = file.add_floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1}, "VEC3", 3);
    file.root["materials"][0].erase("normalTexture");
    const auto coloured = read(file);
    EXPECT_TRUE(mesh_of(coloured.shapes.at(0)).uvs.empty());
    EXPECT_EQ(mesh_of(coloured.shapes.at(0)).more_uvs.size(), 3u);
}

}  // namespace
}  // namespace covtrace::test
