// EXT_meshopt_compression: buffer views that the library's encoder made read as the plain ones.
#include "gltf_meshopt.h"

#include "core/rng.h"

namespace covtrace::test {
namespace {

json& extension_of(GltfFile& file, size_t view) {
    return file.root["bufferViews"][view]["extensions"]["EXT_meshopt_compression"];
}

TEST(GltfMeshopt, ReadsWhatWasCompressed) {
    const GltfFile plain = wave_file(20);
    const TemporaryFolder folder;
    for (const bool triangles : {false, true})
        for (const std::string extension : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
            const GltfFile file = with_meshopt(plain, triangles, extension);
            ASSERT_LT(file.buffer.size(), plain.buffer.size());
            if (triangles) {
                // The encoder turns triangles so that their first index is another one.
                EXPECT_EQ(mesh_of(read(file).shapes.at(0)).triangles.size(), 2u * 19 * 19);
            } else {
                expect_same(read(plain), read(file));
                expect_same(read(plain), read_gltf(folder.write("t.glb", file.binary())));
            }
            EXPECT_EQ(all_warnings(read(file)), all_warnings(read(plain)));
        }
}

TEST(GltfMeshopt, PlaceholdersMayBeMarked) {
    const GltfFile plain = wave_file(5);
    GltfFile file = with_meshopt(plain, false);
    file.more_buffers[0]["extensions"]["EXT_meshopt_compression"]["fallback"] = true;
    expect_same(read(plain), read(file));
    // One with bytes is read, whatever it holds.
    file.more_buffers[0]["uri"] = "data:application/octet-stream;base64,AAAA";
    file.more_buffers[0]["byteLength"] = 3;
    expect_same(read(plain), read(file));
    // One that no compressed view stands for has to have some.
    GltfFile other = plain;
    other.more_buffers = {{{"byteLength", 100}}};
    EXPECT_TRUE(contains(gltf_error(other), "this is no valid glTF"));
}

TEST(GltfMeshopt, TurnsOfTriangles) {
    const auto normal = [](const TriangleMesh& m, size_t i) {
        const auto& t = m.triangles[i];
        return cross(m.positions[t[1]] - m.positions[t[0]], m.positions[t[2]] - m.positions[t[0]]);
    };
    const auto plain = read(wave_file(20)), found = read(with_meshopt(wave_file(20)));
    const TriangleMesh &a = mesh_of(plain.shapes[0]), &b = mesh_of(found.shapes[0]);
    ASSERT_EQ(a.triangles.size(), b.triangles.size());
    for (size_t i = 0; i < a.triangles.size(); ++i) expect_near(normal(a, i), normal(b, i), 1e-6f);
}

TEST(GltfMeshopt, UndoesFilters) {
    // Normals as bytes, a rotation over time, a translation with few bits.
    GltfFile file = wave_file(4);
    const size_t normals = file.root["meshes"][0]["primitives"][0]["attributes"]["NORMAL"];
    std::vector<float> four;
    for (int i = 0; i < 16; ++i) four.insert(four.end(), {0.48f, 0.6f, 0.64f, 0});
    std::string octahedral(16 * 4, '\0');
    meshopt_encodeFilterOct(octahedral.data(), 16, 4, 8, four.data());
    MeshoptStream s = meshopt_attributes(octahedral.data(), 16, 4);
    s.filter = "OCTAHEDRAL";
    const size_t normal_view = file.root["accessors"][normals]["bufferView"];
    set_stream(file, normal_view, s);
    file.root["accessors"][normals].update({{"componentType", 5120}, {"normalized", true}});

    const float h = std::sqrt(0.5f);
    const int times = file.add_floats({0, 1}, "SCALAR", 1);
    const int turns = file.add<int16_t>({0, 0, 0, 0, 0, 0, 0, 0}, 5122, "VEC4", 4, true);
    const int moves = file.add_floats({0, 0, 0, 0, 0, 0}, "VEC3", 3);
    const float rotations[8] = {0, 0, 0, 1, 0, 0, h, h}, positions[6] = {0, 0, 0, 1, 2.5f, -3};
    std::string quaternions(16, '\0'), exponential(24, '\0');
    meshopt_encodeFilterQuat(quaternions.data(), 2, 8, 16, rotations);
    meshopt_encodeFilterExp(exponential.data(), 2, 12, 15, positions);
    s = meshopt_attributes(quaternions.data(), 2, 8);
    s.filter = "QUATERNION";
    set_stream(file, file.root["accessors"][size_t(turns)]["bufferView"], s);
    s = meshopt_attributes(exponential.data(), 2, 12);
    s.filter = "EXPONENTIAL";
    set_stream(file, file.root["accessors"][size_t(moves)]["bufferView"], s);
    const auto channel = [](int sampler, const char* path) {
        return json{{"sampler", sampler}, {"target", {{"node", 0}, {"path", path}}}};
    };
    file.root["animations"] = {
        {{"channels", {channel(0, "rotation"), channel(1, "translation")}},
         {"samplers",
          {{{"input", times}, {"output", turns}}, {{"input", times}, {"output", moves}}}}}};

    const auto scene = read(file, {{}, std::array<float, 2>{0, 1}});
    const ShapeDescription& shape = scene.shapes.at(0);
    expect_near(mesh_of(shape).normals.at(3), {0.48f, 0.6f, 0.64f}, 0.02f);
    expect_near(shape.object_to_world.end().point({1, 0, 0}), {1, 3.5f, -3}, 1e-3f);
}

/// The error of a wave with one thing changed.
template <typename Change>
std::string changed(Change change) {
    GltfFile file = with_meshopt(wave_file(5));
    change(file);
    return gltf_error(file);
}

TEST(GltfMeshopt, RefusesWhatItCannotDecode) {
    // Views 0 to 3: positions, normals, texture coordinates, indices.
    const auto error = [](size_t view, const char* key, const json& value) {
        std::string text = changed([&](GltfFile& f) { extension_of(f, view)[key] = value; });
        const std::string place =
            "t.gltf: bufferViews[" + std::to_string(view) + "].extensions.EXT_meshopt_compression";
        EXPECT_TRUE(text.starts_with(place)) << text;
        return text.substr(std::min(text.size(), place.size()));
    };
    EXPECT_EQ(error(0, "mode", "LINES"), ".mode: expected one of ATTRIBUTES, TRIANGLES, INDICES");
    EXPECT_EQ(error(0, "filter", 3),
              ".filter: expected one of NONE, OCTAHEDRAL, QUATERNION, EXPONENTIAL, COLOR");
    EXPECT_EQ(error(0, "count", -2), ".count: expected a whole number of at least 0");
    EXPECT_EQ(error(0, "byteStride", 1.5), ".byteStride: expected a whole number of at least 0");
    EXPECT_EQ(error(0, "buffer", 7), ": there is no buffers[7]; expected less than 2");
    EXPECT_TRUE(contains(error(0, "byteOffset", 1000000), "its bytes end beyond their buffer"));
    EXPECT_TRUE(contains(error(0, "buffer", 1), "its bytes end beyond their buffer of 1 bytes"));
    EXPECT_EQ(error(0, "count", 24),
              ": its 24 elements of 12 bytes are not those of its buffer view");
    // Strides over which the library would end the process.
    for (const int stride : {0, 2, 6, 260, 1 << 30})
        EXPECT_TRUE(contains(error(0, "byteStride", stride), "expected a byteStride of 4, 8, "));
    EXPECT_TRUE(contains(error(3, "byteStride", 8), "expected a byteStride of 2 or 4"));
    EXPECT_TRUE(contains(error(3, "count", 95), "three indices for each triangle"));
    EXPECT_TRUE(contains(error(3, "filter", "OCTAHEDRAL"), "no filter for indices"));
    for (const char* filter : {"OCTAHEDRAL", "QUATERNION"})
        EXPECT_TRUE(contains(error(0, "filter", filter), "for this filter"));
    EXPECT_EQ(error(0, "byteLength", 40), ": its bytes can't be decoded");
    EXPECT_EQ(error(0, "mode", "INDICES"),
              ": expected a byteStride of 2 or 4 and no filter for indices");
    EXPECT_TRUE(contains(changed([](GltfFile& f) {
                             f.root["images"] = {{{"bufferView", 0}, {"mimeType", "image/png"}}};
                         }),
                         "its bufferView does not lie inside a buffer"));
}

TEST(GltfMeshopt, NamesTheLibraryThatAStreamNeeds) {
    GltfFile file = with_meshopt(wave_file(5), true, "KHR_meshopt_compression");
    const size_t at =
        file.root["bufferViews"][0]["extensions"]["KHR_meshopt_compression"]["byteOffset"];
    ASSERT_EQ(file.buffer[at], char(0xa0));
    GltfFile newer = file;
    newer.buffer[at] = char(0xa1);
    const std::string error = gltf_error(newer);
    if (MESHOPTIMIZER_VERSION < 230) {
        EXPECT_EQ(error.substr(0, error.find(';')),
                  "t.gltf: bufferViews[0].extensions.KHR_meshopt_compression: version 1 of its "
                  "attributes needs libmeshoptimizer 0.23");
    }
    // Uncompressed bytes serve where the file has them.
    const GltfFile plain = wave_file(5);
    const json& view = plain.root["bufferViews"][0];
    newer.more_buffers.push_back(
        {{"byteLength", plain.buffer.size()},
         {"uri", "data:application/octet-stream;base64," + base64(plain.buffer)}});
    newer.root["bufferViews"][0].update(
        {{"buffer", 2}, {"byteOffset", view["byteOffset"]}, {"byteLength", view["byteLength"]}});
    EXPECT_EQ(mesh_of(read(newer).shapes.at(0)).positions.size(), 25u);
}

TEST(GltfMeshopt, LimitsWhatManyViewsDecodeTo) {
    // 2^18 vertices at one place take 4 kB; forty views of them are 126 MB.
    GltfFile file = square_file();
    const std::vector<float> zeros(3 << 18);
    const auto s = meshopt_attributes(reinterpret_cast<const char*>(zeros.data()), 1 << 18, 12);
    ASSERT_LT(s.bytes.size(), 100'000u);
    const size_t view = size_t(file.add_view(""));
    set_stream(file, view, s);
    const json copy = file.root["bufferViews"][view];
    for (int i = 0; i < 40; ++i) file.root["bufferViews"].push_back(copy);
    const Failure f = failure_of([&] { read(file); });
    EXPECT_EQ(f.kind, ErrorKind::limit) << f.message;
    EXPECT_TRUE(contains(f.message, "decode to is too large for a file of")) << f.message;
}

TEST(GltfMeshopt, SurvivesDamagedStreams) {
    const TemporaryFolder folder;
    int read_well = 0;
    constexpr int kRuns = 400;
    Rng rng(12);
    const auto below = [&](size_t n) { return size_t(rng.next_float() * float(n)) % n; };
    for (int run = 0; run < kRuns; ++run) {
        GltfFile file = with_meshopt(wave_file(8), run % 2 == 0);
        if (run % 5 == 0) extension_of(file, 0)["filter"] = "EXPONENTIAL";
        if (run % 7 == 0) {
            json& object = extension_of(file, below(4));
            object["byteLength"] = below(object["byteLength"].get<size_t>());
        } else {
            for (size_t edits = 1 + below(3); edits > 0; --edits)
                file.buffer[below(file.buffer.size())] = static_cast<char>(below(256));
        }
        try {
            read_gltf(folder.write("d.glb", file.binary()));
            ++read_well;
        } catch (const Error& e) {
            EXPECT_TRUE(e.kind() == ErrorKind::scene || e.kind() == ErrorKind::limit) << e.what();
        }
    }
    EXPECT_GT(read_well, kRuns / 20);
    EXPECT_LT(read_well, kRuns * 19 / 20);
}

}  // namespace
}  // namespace covtrace::test
