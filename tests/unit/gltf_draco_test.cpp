// KHR_draco_mesh_compression: primitives that the library's encoder made read as the plain ones.
#include "gltf_draco.h"

#include <algorithm>

#include "core/rng.h"

namespace covtrace::test {
namespace {

constexpr const char* kExtension = "KHR_draco_mesh_compression";

json& primitive_of(GltfFile& file) {
    return file.root["meshes"][0]["primitives"][0];
}

/// The compressed bytes of a file with one primitive, to damage them in place.
std::pair<size_t, size_t> stream_range(const GltfFile& file) {
    const json& extension = file.root["meshes"][0]["primitives"][0]["extensions"][kExtension];
    const json& view = file.root["bufferViews"][extension["bufferView"].get<size_t>()];
    return {view["byteOffset"], view["byteLength"]};
}

TEST(GltfDraco, ReadsWhatWasCompressedWithoutLoss) {
    const GltfFile plain = wave_file(20);
    GltfFile file = with_draco(plain);
    expect_same(read(plain), read(file));
    EXPECT_EQ(all_warnings(read(file)), all_warnings(read(plain)));
    const TemporaryFolder folder;
    expect_same(read(plain), read_gltf(folder.write("t.glb", file.binary())));
    // It counts wherever it stands; the library gives triangles for strips, too.
    file.root.erase("extensionsRequired");
    file.root.erase("extensionsUsed");
    primitive_of(file)["mode"] = 5;
    expect_same(read(plain), read(file));
}

/// The triangles' corners, in an order that does not depend on the file's.
std::vector<std::array<float, 5>> sorted_corners(const SceneDescription& scene) {
    std::vector<std::array<float, 5>> corners;
    const TriangleMesh& m = mesh_of(scene.shapes.at(0));
    for (const auto& t : m.triangles)
        for (const uint32_t i : t)
            corners.push_back(
                {m.positions[i].x, m.positions[i].y, m.positions[i].z, m.normals[i].x, m.uvs[i].x});
    // Coordinates of the grid, so that rounding does not change the order.
    std::sort(corners.begin(), corners.end(), [](const auto& a, const auto& b) {
        const auto key = [](const auto& c) {
            return std::pair(std::lround(c[0] * 19), std::lround(c[1] * 19));
        };
        return key(a) < key(b);
    });
    return corners;
}

TEST(GltfDraco, ReadsConnectivityAndQuantisedPositions) {
    const GltfFile plain = wave_file(20);
    const auto expected = sorted_corners(read(plain));
    const auto found =
        sorted_corners(read(with_draco(plain, draco::MESH_EDGEBREAKER_ENCODING, 14)));
    ASSERT_EQ(found.size(), expected.size());
    for (size_t i = 0; i < found.size(); ++i)
        for (size_t c = 0; c < 5; ++c)
            ASSERT_NEAR(found[i][c], expected[i][c], c < 3 ? 1.0f / (1 << 14) : 0) << i << ' ' << c;
}

TEST(GltfDraco, ReadsIntegersAsTheAccessorsSay) {
    // Positions as shorts, normalised, and joints as bytes that pose the mesh.
    GltfFile file;
    const json attributes = {
        {"POSITION",
         file.add<int16_t>({0, 0, 0, 32767, 0, 0, 0, -32767, 0}, 5122, "VEC3", 3, true)},
        {"JOINTS_0", file.add<uint8_t>({0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, 5121, "VEC4", 4)},
        {"WEIGHTS_0",
         file.add<uint8_t>({255, 0, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0}, 5121, "VEC4", 4, true)}};
    const int indices = file.add<uint16_t>({0, 1, 2}, 5123, "SCALAR", 1);
    file.root["meshes"] = {{{"primitives", {{{"attributes", attributes}, {"indices", indices}}}}}};
    const int bind = file.add_floats({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1,
                                      1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},
                                     "MAT4", 16);
    file.root["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", bind}}};
    file.add_node({{"mesh", 0}, {"skin", 0}});
    file.add_node({{"translation", {0, 0, 1}}});
    file.add_node({{"translation", {0, 0, 2}}});
    const auto scene = read(with_draco(file));
    const TriangleMesh& mesh = mesh_of(scene.shapes.at(0));
    expect_near(mesh.positions[0], {0, 0, 1}, 0);
    expect_near(mesh.positions[1], {1, 0, 2}, 0);
    expect_near(mesh.positions[2], {0, -1, 2}, 0);
}

TEST(GltfDraco, MixesWithPlainAttributesAndIsShared) {
    const GltfFile plain = wave_file(5);
    GltfFile file = with_draco(plain);
    // The texture coordinates stay outside; two primitives, of which one has no normals.
    json& extension = primitive_of(file)["extensions"][kExtension];
    const size_t uv = primitive_of(file)["attributes"]["TEXCOORD_0"];
    extension["attributes"].erase("TEXCOORD_0");
    file.root["accessors"][uv] = plain.root["accessors"][uv];
    json second = primitive_of(file);
    second["attributes"].erase("NORMAL");
    file.root["meshes"][0]["primitives"].push_back(second);
    const auto scene = read(file);
    ASSERT_EQ(scene.shapes.size(), 2u);
    const auto expected_scene = read(plain);
    const TriangleMesh& expected = mesh_of(expected_scene.shapes[0]);
    for (const ShapeDescription& shape : scene.shapes) {
        EXPECT_EQ(mesh_of(shape).triangles, expected.triangles);
        EXPECT_EQ(mesh_of(shape).uvs.at(7).x, expected.uvs.at(7).x);
    }
    EXPECT_EQ(mesh_of(scene.shapes[0]).normals.size(), 25u);
    EXPECT_TRUE(mesh_of(scene.shapes[1]).normals.empty());
}

TEST(GltfDraco, TellsOfOtherCountsInOneLine) {
    GltfFile file = with_draco(wave_file(5));
    file.root["accessors"][0]["count"] = 30;
    file.root["accessors"][1]["count"] = 31;
    EXPECT_TRUE(contains(all_warnings(read(file)),
                         "its accessor is said to have another number of elements than the "
                         "compressed mesh has vertices, which count (and in 1 more place)"));
}

/// The error of a wave with one thing changed.
template <typename Change>
std::string changed(Change change) {
    GltfFile file = with_draco(wave_file(5));
    change(file, primitive_of(file)["extensions"][kExtension],
           file.buffer.data() + stream_range(file).first);
    return gltf_error(file);
}

TEST(GltfDraco, RefusesWhatItCannotDecode) {
    const std::string place =
        "t.gltf: meshes[0].primitives[0].extensions." + std::string(kExtension);
    using File = GltfFile;
    EXPECT_EQ(changed([](File&, json&, char* s) { s[0] = 'X'; }),
              place + ": it can't be decoded: Not a Draco file.");
    EXPECT_EQ(changed([](File&, json&, char* s) { s[6] = 1; }),
              place + ": it can't be decoded: it is of version 2.1; expected 2.2");
    EXPECT_EQ(changed([](File&, json&, char* s) { s[7] = 0; }),
              place + ": it can't be decoded: it holds no triangles");
    EXPECT_EQ(changed([](File&, json&, char* s) { s[8] = 7; }),
              place + ": it can't be decoded: its method 7 is not known");
    EXPECT_EQ(changed([](File&, json& e, char*) { e["bufferView"] = 99; }),
              place + ".bufferView: there is no bufferViews[99]; expected less than 5");
    EXPECT_EQ(changed([](File&, json& e, char*) { e["bufferView"] = -1; }),
              place + ".bufferView: expected a whole number of at least 0");
    EXPECT_EQ(changed([](File&, json& e, char*) { e["attributes"]["NORMAL"] = 9; }),
              place + ".attributes.NORMAL: the compressed mesh has no attribute 9");
    EXPECT_EQ(changed([](File& f, json&, char*) { f.root["accessors"][2]["type"] = "VEC4"; }),
              place +
                  ".attributes.TEXCOORD_0: the compressed attribute has 2 components, another "
                  "number than its accessor");
    EXPECT_EQ(
        changed([](File& f, json&, char*) { f.root["accessors"][0]["componentType"] = 5121; }),
        place + ".attributes.POSITION: value 2 does not fit into the type of its accessor");
    EXPECT_TRUE(contains(changed([](File& f, json& e, char*) {
                             f.root["bufferViews"][e["bufferView"].get<size_t>()]["byteLength"] =
                                 100000;
                         }),
                         "its bytes end beyond their buffer"));
    EXPECT_TRUE(contains(changed([](File& f, json&, char*) { primitive_of(f)["mode"] = 1; }),
                         "only triangles and strips"));
}

TEST(GltfDraco, RefusesPointsThatAreNotThere) {
    // Indices of fewer than 256 vertices that are not worth an entropy code are single bytes.
    GltfFile file = with_draco(square_file());
    const auto [at, length] = stream_range(file);
    ASSERT_GT(length, 20u);
    const std::string indices("\0\1\2\0\2\3", 6);
    const size_t found = file.buffer.find(indices, at);
    ASSERT_LT(found, at + length);
    file.buffer[found + 5] = 4;
    EXPECT_TRUE(contains(gltf_error(file), "it names points or values that are not there"));
}

/// A stream whose header promises this many faces and points, and holds nothing.
std::string promise(int method, uint32_t faces, uint32_t points, char seams) {
    std::string s("DRACO\2\2\1", 8);
    s += std::string{char(method), 0, 0};
    const auto varint = [&s](uint32_t v) {
        for (; v >= 128; v >>= 7) s += static_cast<char>(v | 128);
        s += static_cast<char>(v);
    };
    const bool edges = method == draco::MESH_EDGEBREAKER_ENCODING;
    if (edges) s += '\0';  // standard traversal
    varint(edges ? points : faces);
    varint(edges ? faces : points);
    s += seams;
    varint(faces);
    varint(0);
    return s + std::string(64, '\0');
}

TEST(GltfDraco, LimitsWhatStreamsPromise) {
    for (const auto& [faces, points, seams] :
         {std::tuple(100'000'000u, 50'000'000u, 1), std::tuple(5'000'000u, 10u, 120),
          std::tuple(1'400'000'000u, 4'000'000'000u, 0)}) {
        GltfFile file = with_draco(wave_file(5));
        json& extension = primitive_of(file)["extensions"][kExtension];
        extension["bufferView"] =
            file.add_view(promise(draco::MESH_EDGEBREAKER_ENCODING, faces, points, char(seams)));
        const Failure f = failure_of([&] { read(file); });
        EXPECT_EQ(f.kind, ErrorKind::limit) << f.message;
        EXPECT_TRUE(contains(f.message, "decode to is too large for a file of")) << f.message;
    }
}

TEST(GltfDraco, LimitsWhatManyStreamsDecodeTo) {
    // Each view of the same bytes decodes to 1 MB: a hundred of them are more than 2^26 bytes and
    // 256 for each of the file.
    const GltfFile one = with_draco(wave_file(200), draco::MESH_EDGEBREAKER_ENCODING, 6);
    GltfFile many = one;
    const json primitive = primitive_of(many);
    const json view = many.root["bufferViews"].back();
    for (int i = 0; i < 400; ++i) {
        json copy = primitive;
        copy["extensions"][kExtension]["bufferView"] = many.root["bufferViews"].size();
        many.root["bufferViews"].push_back(view);
        many.root["meshes"][0]["primitives"].push_back(copy);
    }
    // The plain bytes, which the test's file still holds, are left out.
    const auto [at, length] = stream_range(one);
    many.buffer = one.buffer.substr(at, length);
    for (json& v : many.root["bufferViews"]) {
        v["byteOffset"] = 0;
        v["byteLength"] = length;
    }
    const Failure f = failure_of([&] { read(many); });
    EXPECT_EQ(f.kind, ErrorKind::limit) << f.message;
    EXPECT_TRUE(contains(f.message, "decode to is too large")) << f.message;
}

TEST(GltfDraco, SurvivesDamagedStreams) {
    const TemporaryFolder folder;
    int read_well = 0;
    constexpr int kRuns = 400;
    for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
        const GltfFile sound = with_draco(wave_file(8), method, 10);
        const auto [at, length] = stream_range(sound);
        Rng rng(11);
        const auto below = [&](size_t n) { return size_t(rng.next_float() * float(n)) % n; };
        for (int run = 0; run < kRuns; ++run) {
            GltfFile file = sound;
            for (size_t edits = 1 + below(3); edits > 0; --edits)
                file.buffer[at + below(length)] = static_cast<char>(below(256));
            if (run % 8 == 0) {
                json& extension = primitive_of(file)["extensions"][kExtension];
                file.root["bufferViews"][extension["bufferView"].get<size_t>()]["byteLength"] =
                    below(length);
            }
            try {
                read_gltf(folder.write("d.glb", file.binary()));
                ++read_well;
            } catch (const Error& e) {
                EXPECT_TRUE(e.kind() == ErrorKind::scene || e.kind() == ErrorKind::limit)
                    << e.what();
            }
        }
    }
    EXPECT_GT(read_well, 2 * kRuns / 20);
    EXPECT_LT(read_well, 2 * kRuns * 19 / 20);
}

}  // namespace
}  // namespace covtrace::test
