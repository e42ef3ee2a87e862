/// Support for the tests of glTF files that meshopt compresses: the library's own encoder.
#pragma once

#include <meshoptimizer.h>

#include "gltf_fixtures.h"

namespace covtrace::test {

/// A stream, and what the extension's object says of it.
struct MeshoptStream {
    std::string bytes;
    size_t stride = 0, count = 0;
    const char* mode = "ATTRIBUTES";
    const char* filter = nullptr;
};

/// Elements of `size` bytes, padded to a stride of a multiple of four.
inline MeshoptStream meshopt_attributes(const char* data, size_t count, size_t size) {
    MeshoptStream s{.bytes = {}, .stride = (size + 3) / 4 * 4, .count = count};
    std::string padded(count * s.stride, '\0');
    for (size_t i = 0; i < count; ++i) std::memcpy(&padded[i * s.stride], data + i * size, size);
    s.bytes.resize(meshopt_encodeVertexBufferBound(count, s.stride));
    s.bytes.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(s.bytes.data()),
                                              s.bytes.size(), padded.data(), count, s.stride));
    return s;
}

inline MeshoptStream meshopt_indices(const std::vector<uint32_t>& indices, bool triangles,
                                     size_t stride) {
    meshopt_encodeIndexVersion(1);
    MeshoptStream s{.bytes = {}, .stride = stride, .count = indices.size()};
    const size_t count = indices.size(), vertices = 65536;
    s.mode = triangles ? "TRIANGLES" : "INDICES";
    s.bytes.resize(triangles ? meshopt_encodeIndexBufferBound(count, vertices)
                             : meshopt_encodeIndexSequenceBound(count, vertices));
    auto* to = reinterpret_cast<unsigned char*>(s.bytes.data());
    s.bytes.resize(triangles
                       ? meshopt_encodeIndexBuffer(to, s.bytes.size(), indices.data(), count)
                       : meshopt_encodeIndexSequence(to, s.bytes.size(), indices.data(), count));
    return s;
}

/// Puts a stream into the place of bufferViews[view]; the uncompressed bytes are those of buffer 1,
/// which holds none.
inline void set_stream(GltfFile& file, size_t view, const MeshoptStream& s,
                       const std::string& extension = "EXT_meshopt_compression") {
    file.buffer.resize((file.buffer.size() + 3) / 4 * 4);
    json object = {{"buffer", 0},
                   {"byteOffset", file.buffer.size()},
                   {"byteLength", s.bytes.size()},
                   {"byteStride", s.stride},
                   {"count", s.count},
                   {"mode", s.mode}};
    if (s.filter) object["filter"] = s.filter;
    file.buffer += s.bytes;
    const size_t length = s.count * s.stride;
    json& v = file.root["bufferViews"][view];
    v = {{"buffer", 1}, {"byteLength", length}, {"extensions", {{extension, object}}}};
    if (file.more_buffers.empty()) file.more_buffers = {{{"byteLength", 0}}};
    json& held = file.more_buffers[0]["byteLength"];
    v["byteOffset"] = held;
    held = held.get<size_t>() + length;
    if (std::string(s.mode) == "ATTRIBUTES") v["byteStride"] = s.stride;
}

/// The file with the bytes of all its accessors compressed, each of which has a view of its own.
/// Scalars of 16 bits are indices: `triangles` says in which mode.
inline GltfFile with_meshopt(const GltfFile& plain, bool triangles = true,
                             const std::string& extension = "EXT_meshopt_compression") {
    GltfFile file = plain;
    file.buffer.clear();
    for (const json& accessor : plain.root["accessors"]) {
        const char* bytes = accessor_bytes(plain, accessor);
        const size_t view = accessor["bufferView"], count = accessor["count"];
        const size_t held = plain.root["bufferViews"][view]["byteLength"];
        if (accessor["type"] == "SCALAR" && accessor["componentType"] == 5123) {
            std::vector<uint32_t> indices(count);
            for (size_t i = 0; i < count; ++i) {
                uint16_t index = 0;
                std::memcpy(&index, bytes + 2 * i, sizeof index);
                indices[i] = index;
            }
            set_stream(file, view, meshopt_indices(indices, triangles, 2), extension);
        } else {
            set_stream(file, view, meshopt_attributes(bytes, count, held / count), extension);
        }
    }
    file.root["extensionsUsed"] = {extension};
    file.root["extensionsRequired"] = {extension};
    return file;
}

}  // namespace covtrace::test
