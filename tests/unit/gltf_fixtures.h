/// Support for the tests of the glTF reader: small documents, written as files.
#pragma once

#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "gltf/read_gltf.h"
#include "pbrt_test_support.h"
#include "scene/defaults.h"

namespace covtrace::test {

using nlohmann::json;

inline std::string base64(const std::string& bytes) {
    static const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        uint32_t v = 0;
        for (size_t k = 0; k < 3; ++k)
            v = v << 8 | (i + k < bytes.size() ? static_cast<uint8_t>(bytes[i + k]) : 0u);
        for (size_t k = 0; k < 4; ++k)
            text += i + k > bytes.size() ? '=' : digits[v >> (18 - 6 * k) & 63];
    }
    return text;
}

/// A document that grows: one buffer, views and accessors for the values that are appended to it.
struct GltfFile {
    json root = {{"asset", {{"version", "2.0"}}}, {"nodes", json::array()}};
    std::string buffer;
    json more_buffers = json::array();  ///< behind the first, which holds `buffer`

    int add_view(const std::string& bytes, int stride = 0) {
        buffer.resize((buffer.size() + 3) / 4 * 4);
        json view = {{"buffer", 0}, {"byteOffset", buffer.size()}, {"byteLength", bytes.size()}};
        if (stride > 0) view["byteStride"] = stride;
        buffer += bytes;
        root["bufferViews"].push_back(view);
        return static_cast<int>(root["bufferViews"].size()) - 1;
    }
    template <typename T>
    int add(const std::vector<T>& values, int component_type, const std::string& type,
            size_t components, bool normalized = false) {
        std::string bytes(values.size() * sizeof(T), '\0');
        std::memcpy(bytes.data(), values.data(), bytes.size());
        json accessor = {{"bufferView", add_view(bytes)},
                         {"componentType", component_type},
                         {"count", values.size() / components},
                         {"type", type}};
        if (normalized) accessor["normalized"] = true;
        root["accessors"].push_back(accessor);
        return static_cast<int>(root["accessors"].size()) - 1;
    }
    int add_floats(const std::vector<float>& v, const std::string& type, size_t components) {
        return add(v, 5126, type, components);
    }
    /// Adds the unit square in z = 0 as a mesh of its own, with uv as an image has it: v downwards.
    int add_square(const json& more = json::object()) {
        const int positions = add_floats({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, "VEC3", 3);
        const int uvs = add_floats({0, 1, 1, 1, 1, 0, 0, 0}, "VEC2", 2);
        const int indices = add<uint16_t>({0, 1, 2, 0, 2, 3}, 5123, "SCALAR", 1);
        json primitive = {{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uvs}}},
                          {"indices", indices}};
        primitive.update(more);
        root["meshes"].push_back({{"primitives", {primitive}}});
        return static_cast<int>(root["meshes"].size()) - 1;
    }
    int add_node(const json& node) {
        root["nodes"].push_back(node);
        return static_cast<int>(root["nodes"].size()) - 1;
    }
    /// The buffer as a data URI.
    std::string text() const {
        json all = root;
        if (!buffer.empty())
            all["buffers"] = {{{"byteLength", buffer.size()},
                               {"uri", "data:application/octet-stream;base64," + base64(buffer)}}};
        for (const json& b : more_buffers) all["buffers"].push_back(b);
        return all.dump(1);
    }
    std::string binary() const {
        json all = root;
        std::string body = buffer;
        body.resize((body.size() + 3) / 4 * 4);
        if (!body.empty()) all["buffers"] = {{{"byteLength", body.size()}}};
        for (const json& b : more_buffers) all["buffers"].push_back(b);
        std::string head = all.dump();
        head.resize((head.size() + 3) / 4 * 4, ' ');
        const auto word = [](size_t v) {
            std::string s;
            for (int i = 0; i < 4; ++i) s += static_cast<char>(v >> (8 * i) & 255);
            return s;
        };
        const std::string chunks =
            word(head.size()) + "JSON" + head +
            (body.empty() ? std::string() : word(body.size()) + std::string("BIN\0", 4) + body);
        return "glTF" + word(2) + word(12 + chunks.size()) + chunks;
    }
};

/// A file with the square on one node.
inline GltfFile square_file() {
    GltfFile file;
    file.add_node({{"mesh", file.add_square()}});
    return file;
}

/// The bytes of an accessor of a GltfFile, whose elements are packed.
inline const char* accessor_bytes(const GltfFile& file, const json& accessor) {
    const size_t view = accessor["bufferView"];
    return file.buffer.data() + file.root["bufferViews"][view]["byteOffset"].get<size_t>();
}

/// A wavy square of n by n vertices with normals and texture coordinates, on one node.
inline GltfFile wave_file(int n) {
    GltfFile file;
    std::vector<float> points, normals, uvs;
    std::vector<uint16_t> indices;
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            const float u = float(x) / float(n - 1), v = float(y) / float(n - 1);
            points.insert(points.end(), {u, v, 0.2f * std::sin(9 * u) * std::cos(7 * v)});
            normals.insert(normals.end(), {0.6f * u, 0.8f * u, std::sqrt(1 - u * u)});
            uvs.insert(uvs.end(), {u, 1 - v});
        }
    for (int y = 0; y + 1 < n; ++y)
        for (int x = 0; x + 1 < n; ++x)
            for (const int k : {0, 1, n + 1, 0, n + 1, n})
                indices.push_back(uint16_t(y * n + x + k));
    const json attributes = {{"POSITION", file.add_floats(points, "VEC3", 3)},
                             {"NORMAL", file.add_floats(normals, "VEC3", 3)},
                             {"TEXCOORD_0", file.add_floats(uvs, "VEC2", 2)}};
    const int corners = file.add<uint16_t>(indices, 5123, "SCALAR", 1);
    file.root["meshes"] = {{{"primitives", {{{"attributes", attributes}, {"indices", corners}}}}}};
    file.add_node({{"mesh", 0}});
    return file;
}

/// The scene with stand-ins for a camera or lights.
inline SceneDescription read_text(const std::string& text, const ReadOptions& options = {}) {
    const TemporaryFolder folder;
    SceneDescription scene = read_gltf(folder.write("t.gltf", text), options);
    complete(scene);
    return scene;
}
inline SceneDescription read(const GltfFile& file, const ReadOptions& options = {}) {
    return read_text(file.text(), options);
}
/// The error's message without the folder of the test.
inline std::string gltf_error(const std::string& text) {
    const TemporaryFolder folder;
    const auto path = folder.write("t.gltf", text);
    const Failure f = failure_of([&] { read_gltf(path); });
    EXPECT_EQ(f.kind, ErrorKind::scene) << f.message;
    const std::string prefix = folder.path().string() + "/";
    EXPECT_TRUE(f.message.starts_with(prefix)) << f.message;
    return f.message.substr(std::min(prefix.size(), f.message.size()));
}
inline std::string gltf_error(const GltfFile& file) {
    return gltf_error(file.text());
}
inline std::string all_warnings(const SceneDescription& scene) {
    std::string all;
    for (const Warning& w : scene.warnings) all += w.where.to_string() + ": " + w.text + "\n";
    return all;
}
inline const TriangleMesh& mesh_of(const ShapeDescription& shape) {
    return *std::get<std::shared_ptr<const TriangleMesh>>(shape.geometry);
}
/// Expects the same triangles, vertex by vertex.
inline void expect_same(const SceneDescription& a, const SceneDescription& b) {
    ASSERT_EQ(a.shapes.size(), b.shapes.size());
    for (size_t s = 0; s < a.shapes.size(); ++s) {
        const TriangleMesh &m = mesh_of(a.shapes[s]), &n = mesh_of(b.shapes[s]);
        EXPECT_EQ(m.triangles, n.triangles);
        ASSERT_EQ(m.positions.size(), n.positions.size());
        ASSERT_EQ(m.normals.size(), n.normals.size());
        ASSERT_EQ(m.uvs.size(), n.uvs.size());
        for (size_t i = 0; i < m.positions.size(); ++i)
            expect_near(m.positions[i], n.positions[i], 0);
        for (size_t i = 0; i < m.normals.size(); ++i) expect_near(m.normals[i], n.normals[i], 0);
        for (size_t i = 0; i < m.uvs.size(); ++i) EXPECT_EQ(m.uvs[i].y, n.uvs[i].y);
    }
}
template <typename T>
const T& model_of(const SceneDescription& scene, MaterialId id) {
    return std::get<T>(scene.materials.at(static_cast<size_t>(id)).value);
}

}  // namespace covtrace::test
