// Errors of glTF files are told with their place; hostile files never crash.
#include <fstream>

#include "core/rng.h"
#include "gltf_fixtures.h"

namespace covtrace::test {
namespace {

TEST(GltfErrors, TellsWhereTheTextIsNoJson) {
    EXPECT_TRUE(contains(gltf_error("{\n  \"asset\": {\"version\" \"2.0\"}}"),
                         "t.gltf:2:27: this is no JSON"));
    EXPECT_TRUE(contains(gltf_error(""), "t.gltf:1:1: this is no JSON"));
    EXPECT_TRUE(contains(gltf_error("[]"), "expected a JSON object"));
    EXPECT_TRUE(contains(gltf_error(std::string(100000, '[')), "128 levels"));
    EXPECT_TRUE(contains(gltf_error("{}"), "asset.version is missing"));
    EXPECT_TRUE(contains(gltf_error(R"({"asset":{"version":"1.0"}})"), "expected \"2.0\""));
    EXPECT_TRUE(contains(gltf_error("glTF\2"), "cut short"));
}

TEST(GltfErrors, HoldsTheLengthsOfBinaryFilesAgainstTheirBytes) {
    const TemporaryFolder folder;
    const std::string whole = square_file().binary();
    uint32_t json_length = 0;
    std::memcpy(&json_length, whole.data() + 12, sizeof json_length);
    const auto with_more = [&](size_t at, uint32_t more) {
        std::string bytes = whole;
        uint32_t word = 0;
        std::memcpy(&word, bytes.data() + at, sizeof word);
        word += more;
        std::memcpy(bytes.data() + at, &word, sizeof word);
        return failure_of([&] { read_gltf(folder.write("t.glb", bytes)); }).message;
    };
    // The file's length, that of the JSON and that of the buffers, whose bytes end the file.
    for (const size_t at : {size_t{8}, size_t{12}, size_t{20} + json_length})
        for (const uint32_t more : {1000u, 1000000u})
            EXPECT_TRUE(contains(with_more(at, more), "cut short")) << at << ' ' << more;
    for (const uint32_t more : {4u, 8u})
        EXPECT_TRUE(contains(with_more(20 + json_length, more), "cut short")) << more;
    // A file of version 1 has the length of its JSON where version 2 has that of a chunk's header
    std::string old = whole;
    const uint32_t words[] = {1, static_cast<uint32_t>(whole.size()), json_length, 0};
    std::memcpy(old.data() + 4, words, sizeof words);
    EXPECT_EQ(
        failure_of([&] { read_gltf(folder.write("old.glb", old)); }).message,
        (folder.path() / "old.glb").string() + ": binary glTF of version 1; expected version 2");
}

/// The square with one thing changed.
template <typename Change>
std::string changed(Change change) {
    GltfFile file = square_file();
    change(file.root);
    return gltf_error(file);
}

TEST(GltfErrors, TellsThePlaceInTheDocument) {
    const auto primitive = [](json& r) -> json& { return r["meshes"][0]["primitives"][0]; };
    EXPECT_EQ(changed([](json& r) { r["nodes"][0]["mesh"] = 7; }),
              "t.gltf: nodes[0].mesh: there is no meshes[7]; expected less than 1");
    EXPECT_EQ(changed([&](json& r) { primitive(r)["attributes"]["POSITION"] = 99; }),
              "t.gltf: meshes[0].primitives[0].attributes.POSITION: there is no accessors[99]; "
              "expected less than 3");
    EXPECT_EQ(changed([&](json& r) { primitive(r)["material"] = 3; }),
              "t.gltf: meshes[0].primitives[0]: there is no materials[3]; the file has none");
    EXPECT_EQ(changed([](json& r) { r["accessors"][0]["count"] = 5; }),
              "t.gltf: accessors[0]: 5 elements end beyond the buffer view of 48 bytes");
    EXPECT_EQ(changed([](json& r) { r["accessors"][0]["byteOffset"] = 4294967295u; }),
              "t.gltf: accessors[0]: 4 elements end beyond the buffer view of 48 bytes");
    EXPECT_EQ(changed([](json& r) { r["bufferViews"][0]["byteLength"] = 1e6; }).substr(0, 30),
              std::string("t.gltf: this is no valid glTF: ").substr(0, 30));
    EXPECT_EQ(changed([](json& r) { r["bufferViews"][0]["byteLength"] = 1000; }),
              "t.gltf: bufferViews[0]: it ends beyond its buffer of 92 bytes");
    EXPECT_EQ(changed([](json& r) { r["accessors"][1]["count"] = 3; }),
              "t.gltf: meshes[0].primitives[0].attributes.TEXCOORD_0: has 3 elements; expected 4, "
              "one per position");
    EXPECT_EQ(changed([](json& r) { r["accessors"][0]["type"] = "VEC2"; }),
              "t.gltf: accessors[0]: expected elements of 3 numbers, found 2");
    EXPECT_EQ(changed([](json& r) {
                  r["nodes"][0]["rotation"] = {1, 2};
              }),
              "t.gltf: nodes[0].rotation: expected 4 numbers");
    EXPECT_EQ(
        changed([](json& r) { r["extensionsRequired"] = {"KHR_texture_basisu"}; }),
        "t.gltf: extensionsRequired: the file can't be read without the extension "
        "KHR_texture_basisu, which is not supported; 'gltf-transform ktxdecompress' makes PNGs "
        "of its textures");
}

TEST(GltfErrors, NamesRequiredExtensionsBeforeTheRestIsRead) {
    // The accessors of compressed meshes have no buffer view, embedded images none of their type.
    const auto compressed = [](json& r) {
        r["extensionsRequired"] = {"KHR_mesh_quantization", "EXT_of_tomorrow", "EXT_\nof_a_dream"};
        r["textures"] = {{{"sampler", "none"}}};
        r["bufferViews"][0]["byteLength"] = "long";
    };
    EXPECT_EQ(changed(compressed),
              "t.gltf: extensionsRequired: the file can't be read without the extensions "
              "EXT_of_tomorrow, EXT_?of_a_dream, which are not supported");
    EXPECT_TRUE(contains(changed([&](json& r) {
                             compressed(r);
                             r["extensionsRequired"] = {"KHR_mesh_quantization", 7};
                         }),
                         "this is no valid glTF"));
}

TEST(GltfErrors, LimitsCounts) {
    GltfFile file = square_file();
    file.root["accessors"][0]["count"] = 18446744073709551615u;
    const Failure f = failure_of([&] { read(file); });
    EXPECT_EQ(f.kind, ErrorKind::limit);
    EXPECT_TRUE(contains(f.message, "more than 2^30 vertices"));
}

/// Asserts Error(limit) with this text.
void expect_limit(const GltfFile& file, const std::string& text, const ReadOptions& options = {}) {
    const Failure f = failure_of([&] { read(file, options); });
    EXPECT_EQ(f.kind, ErrorKind::limit) << f.message;
    EXPECT_TRUE(contains(f.message, text)) << f.message;
}

TEST(GltfErrors, LimitsWhatPrimitivesMakeOfOneBuffer) {
    // 2000 primitives of the same 100 000 triangles without area would take 2.4 GB.
    GltfFile file;
    const int points = file.add_floats({0, 0, 0, 1, 0, 0, 1, 1, 0}, "VEC3", 3);
    const int indices = file.add(std::vector<uint8_t>(300'000), 5121, "SCALAR", 1);
    const json primitive = {{"attributes", {{"POSITION", points}}}, {"indices", indices}};
    file.root["meshes"] = {{{"primitives", std::vector<json>(2000, primitive)}}};
    file.add_node({{"mesh", 0}});
    expect_limit(file, "too large for a file of");
    // The file costs time alone as strips, of which nothing would be kept.
    GltfFile strips = file;
    for (json& p : strips.root["meshes"][0]["primitives"]) p["mode"] = 5;
    expect_limit(strips, "too many for a file of");
}

TEST(GltfErrors, LimitsAnimationsWithoutBytes) {
    GltfFile file = square_file();
    const auto zeros = [&](const char* type) {
        file.root["accessors"].push_back(
            {{"componentType", 5126}, {"count", 1 << 23}, {"type", type}});
        return file.root["accessors"].size() - 1;
    };
    const json sampler = {{"input", zeros("SCALAR")}, {"output", zeros("VEC3")}};
    json channels = json::array();
    for (int i = 0; i < 20; ++i) {
        file.add_node({{"mesh", 0}});
        channels.push_back({{"sampler", 0}, {"target", {{"node", i}, {"path", "translation"}}}});
    }
    file.root["animations"] = {{{"channels", channels}, {"samplers", {sampler}}}};
    expect_limit(file, "too many for a file of", {{}, std::array<float, 2>{0, 1}});
}

TEST(GltfErrors, RefusesIndicesBeyondTheVertices) {
    GltfFile file = square_file();
    file.buffer[file.buffer.size() - 2] = 4;
    EXPECT_EQ(gltf_error(file),
              "t.gltf: meshes[0].primitives[0].indices: index 4 is beyond the 4 vertices");
}

TEST(GltfErrors, RefusesValuesThatAreNotFinite) {
    GltfFile file = square_file();
    const float nan = std::nanf("");
    std::memcpy(file.buffer.data() + 12, &nan, sizeof nan);
    EXPECT_EQ(gltf_error(file), "t.gltf: accessors[0]: element 1 is not finite");
}

TEST(GltfErrors, RefusesHierarchiesThatAreNoTrees) {
    const auto nodes = [](json n, json scene) {
        return changed([&](json& r) {
            r["nodes"] = n;
            r["scenes"] = {{{"nodes", scene}}};
        });
    };
    EXPECT_TRUE(
        contains(nodes({{{"children", {1}}}, {{"children", {0}}}}, {0}), "is below itself"));
    EXPECT_TRUE(contains(nodes({{{"children", {0}}}}, {0}), "is below itself"));
    EXPECT_TRUE(
        contains(nodes({{{"children", {1}}}, {{"children", {2}}}, {{"children", {1}}}}, {0}),
                 "expected a tree"));
    EXPECT_TRUE(contains(nodes({{{"children", {1, 1}}}, {{"mesh", 0}}}, {0}), "expected a tree"));
    EXPECT_TRUE(contains(nodes({{{"children", {5}}}}, {0}), "there is no nodes[5]"));
}

TEST(GltfErrors, ReadsNoFileOutsideTheScene) {
    const TemporaryFolder folder;
    folder.write("secret.bin", square_file().buffer);
    folder.write("inside/part 1.bin", square_file().buffer);
    const auto with_uri = [&](const std::string& uri) {
        GltfFile file = square_file();
        json all = file.root;
        all["buffers"] = {{{"byteLength", file.buffer.size()}, {"uri", uri}}};
        return folder.write("inside/t.gltf", all.dump());
    };
    EXPECT_EQ(read_gltf(with_uri("part%201.bin")).shapes.size(), 1u);
    for (const std::string uri : {"../secret.bin", "%2e%2e/secret.bin", "x/../../secret.bin"})
        EXPECT_TRUE(contains(failure_of([&] { read_gltf(with_uri(uri)); }).message,
                             "outside the scene's folder"))
            << uri;
    std::filesystem::create_symlink(folder.path() / "secret.bin", folder.path() / "inside/link");
    EXPECT_TRUE(contains(failure_of([&] { read_gltf(with_uri("link")); }).message,
                         "outside the scene's folder"));
    for (const std::string uri : {"/etc/hostname", "file:///etc/hostname", "https://a/b"})
        EXPECT_TRUE(contains(failure_of([&] { read_gltf(with_uri(uri)); }).message,
                             "expected a relative path"))
            << uri;
    EXPECT_TRUE(contains(failure_of([&] { read_gltf(with_uri("none.bin")); }).message,
                         "\"none.bin\" not found"));
    // A search path makes its files the scene's.
    const auto found = read_gltf(with_uri("secret.bin"), {{folder.path()}, {}});
    EXPECT_EQ(found.shapes.size(), 1u);
}

/// A file with everything that the reader knows.
GltfFile rich_file() {
    GltfFile file;
    const std::string image = "\x89PNG\r\n\x1a\n";
    file.root["images"] = {{{"bufferView", file.add_view(image)}, {"mimeType", "image/png"}}};
    file.root["textures"] = {{{"source", 0}, {"sampler", 0}}};
    file.root["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}}};
    const json texture = {
        {"index", 0},
        {"extensions", {{"KHR_texture_transform", {{"offset", {0.1, 0}}, {"rotation", 0.5}}}}}};
    file.root["materials"] = {
        {{"pbrMetallicRoughness", {{"baseColorTexture", texture}, {"metallicFactor", 0.5}}},
         {"normalTexture", {{"index", 0}, {"scale", 2}, {"texCoord", 1}}},
         {"alphaMode", "MASK"},
         {"emissiveFactor", {1, 1, 1}},
         {"extensions",
          {{"KHR_materials_clearcoat", {{"clearcoatFactor", 0.5}}},
           {"KHR_materials_transmission", {{"transmissionFactor", 0.5}}},
           {"KHR_materials_volume", {{"thicknessFactor", 1}, {"attenuationDistance", 1}}},
           {"KHR_materials_ior", {{"ior", 1.3}}},
           {"KHR_materials_emissive_strength", {{"emissiveStrength", 4}}}}}}};
    file.root["cameras"] = {
        {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}}};
    file.root["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "spot"}, {"intensity", 5}, {"spot", json::object()}}};
    const int square = file.add_square({{"material", 0}});
    const int times = file.add_floats({0, 1}, "SCALAR", 1);
    const int turns = file.add_floats({0, 0, 0, 1, 0, 0, 1, 0}, "VEC4", 4);
    file.add_node({{"mesh", square}, {"children", {1, 2}}, {"matrix", json::array()}});
    file.root["nodes"][0].erase("matrix");
    file.add_node({{"camera", 0}, {"translation", {0, 0, 5}}});
    file.add_node({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    const int target = file.add_floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3);
    const json four = {{"JOINTS_0", file.add<uint8_t>(std::vector<uint8_t>(16), 5121, "VEC4", 4)},
                       {"WEIGHTS_0", file.add_floats(std::vector<float>(16, 0.25f), "VEC4", 4)}};
    file.root["meshes"][0]["primitives"][0]["attributes"].update(four);
    const json values = {
        {"COLOR_0", file.add<uint8_t>({255, 0, 9, 80, 0, 7, 0, 255, 5, 4, 3, 2, 1, 0, 1, 255}, 5121,
                                      "VEC4", 4, true)},
        {"TEXCOORD_1", file.add_floats({0, 0, 1, 0, 1, 1, 0, 1}, "VEC2", 2)}};
    file.root["meshes"][0]["primitives"][0]["attributes"].update(values);
    file.root["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", target}}};
    const int bind = file.add_floats({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, "MAT4", 16);
    file.root["skins"] = {{{"joints", {2}}, {"inverseBindMatrices", bind}}};
    file.root["nodes"][0]["skin"] = 0;
    const int weights = file.add_floats({0, 1}, "SCALAR", 1);
    file.root["animations"] = {
        {{"channels",
          {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "rotation"}}}},
           {{"sampler", 1}, {"target", {{"node", 0}, {"path", "weights"}}}}}},
         {"samplers",
          {{{"input", times}, {"output", turns}}, {{"input", times}, {"output", weights}}}}}};
    return file;
}

TEST(GltfErrors, NumbersThatSinglePrecisionCannotHold) {
    const auto error_with = [](const json& camera, const json& light) {
        GltfFile file = square_file();
        file.root["cameras"] = json::array({camera});
        file.root["extensions"]["KHR_lights_punctual"]["lights"] = json::array({light});
        file.add_node({{"camera", 0}});
        file.add_node({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
        return gltf_error(file);
    };
    const json light = {{"type", "point"}, {"intensity", 5}};
    const json camera = {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}};
    const auto perspective = [](double yfov) {
        return json{{"type", "perspective"}, {"perspective", {{"yfov", yfov}, {"znear", 1}}}};
    };
    const auto orthographic = [](double x, double y) {
        return json{{"type", "orthographic"},
                    {"orthographic", {{"xmag", x}, {"ymag", y}, {"zfar", 9}, {"znear", 1}}}};
    };
    for (const double yfov : {1e-30, 1e-60, 1e-9})
        EXPECT_TRUE(contains(error_with(perspective(yfov), light),
                             "cameras[0].perspective: expected a field of view"))
            << yfov;
    for (const auto& [x, y] : {std::pair(1e-40, 1.0), std::pair(1.0, 1e20)})
        EXPECT_TRUE(contains(error_with(orthographic(x, y), light),
                             "cameras[0].orthographic: expected xmag and ymag from"));
    EXPECT_TRUE(contains(
        error_with(camera, {{"type", "point"}, {"intensity", 1e20}, {"color", {1e20, 1, 1}}}),
        "lights[0]: expected a product of color and intensity"));
}

TEST(GltfErrors, SurvivesDamagedFiles) {
    const TemporaryFolder folder;
    const ReadOptions options{{}, std::array<float, 2>{0.2f, 0.8f}};
    const std::string text = rich_file().text(), binary = rich_file().binary();
    EXPECT_NO_THROW(read_gltf(folder.write("ok.gltf", text), options));
    EXPECT_NO_THROW(read_gltf(folder.write("ok.glb", binary), options));
    Rng rng(8);
    const std::vector<std::string> tokens{
        "-1",   "0",   "1",     "4294967296", "1e308",
        "null", "[]",  "{}",    "\"x\"",      "true",
        "255",  "0.5", "[0,0]", "-1e9",       "18446744073709551615"};
    int read_well = 0;
    constexpr int kRuns = 600;
    for (int run = 0; run < kRuns; ++run) {
        const bool is_text = run % 3 != 0;
        std::string file = is_text ? text : binary;
        const auto below = [&](size_t n) { return size_t(rng.next_float() * float(n)) % n; };
        for (size_t edits = 1 + below(3); edits > 0; --edits) {
            const size_t at = below(file.size());
            if (!is_text || below(4) == 0) {
                file[at] = static_cast<char>(below(256));
                continue;
            }
            // A number becomes another value.
            const size_t begin = file.find_first_of("0123456789", at);
            if (begin == std::string::npos) continue;
            const size_t end = file.find_first_not_of("0123456789.e-", begin);
            file.replace(begin, end - begin, tokens[below(tokens.size())]);
        }
        const auto path = folder.write(is_text ? "d.gltf" : "d.glb", file);
        try {
            read_gltf(path, options);
            ++read_well;
        } catch (const Error& e) {
            EXPECT_TRUE(e.kind() == ErrorKind::scene || e.kind() == ErrorKind::limit) << e.what();
            EXPECT_NE(std::string(e.what()).find("d.gl"), std::string::npos) << e.what();
        }
    }
    // The damage is neither always fatal nor never.
    EXPECT_GT(read_well, kRuns / 20);
    EXPECT_LT(read_well, kRuns * 19 / 20);
}

}  // namespace
}  // namespace covtrace::test
