/// Support for the tests of glTF files that Draco compresses: the library's own encoder.
#pragma once

#include <draco/compression/expert_encode.h>

#include "gltf_fixtures.h"

namespace covtrace::test {

inline draco::DataType draco_type(int component_type) {
    switch (component_type) {
        case 5120:
            return draco::DT_INT8;
        case 5121:
            return draco::DT_UINT8;
        case 5122:
            return draco::DT_INT16;
        case 5123:
            return draco::DT_UINT16;
        case 5125:
            return draco::DT_UINT32;
        default:
            return draco::DT_FLOAT32;
    }
}

/// A primitive with indices of 16 bits as a stream. `method`: draco::MESH_SEQUENTIAL_ENCODING,
/// which keeps the order of vertices, or MESH_EDGEBREAKER_ENCODING. `bits` of the positions, 0
/// keeps floats as they are. Attributes get the ids 0, 1, … in the order of their names.
inline std::string draco_stream(const GltfFile& file, const json& primitive, int method,
                                int bits = 0) {
    draco::Mesh mesh;
    const json& accessors = file.root["accessors"];
    const json& indices = accessors[primitive["indices"].get<size_t>()];
    std::vector<uint16_t> corners(indices["count"].get<size_t>());
    std::memcpy(corners.data(), accessor_bytes(file, indices), corners.size() * 2);
    for (size_t i = 0; i + 2 < corners.size(); i += 3)
        mesh.AddFace({draco::PointIndex(corners[i]), draco::PointIndex(corners[i + 1]),
                      draco::PointIndex(corners[i + 2])});
    for (const auto& [name, index] : primitive["attributes"].items()) {
        const json& accessor = accessors[index.get<size_t>()];
        const auto count = accessor["count"].get<uint32_t>();
        mesh.set_num_points(count);
        const std::string type = accessor["type"];
        const auto components = int8_t(type == "SCALAR" ? 1 : type.back() - '0');
        const draco::DataType data_type = draco_type(accessor["componentType"]);
        const int64_t stride = components * draco::DataTypeLength(data_type);
        draco::GeometryAttribute attribute;
        attribute.Init(name == "POSITION" ? draco::GeometryAttribute::POSITION
                       : name == "NORMAL" ? draco::GeometryAttribute::NORMAL
                                          : draco::GeometryAttribute::GENERIC,
                       nullptr, components, data_type, false, stride, 0);
        const int id = mesh.AddAttribute(attribute, true, count);
        const char* bytes = accessor_bytes(file, accessor);
        for (uint32_t i = 0; i < count; ++i)
            mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i),
                                                  bytes + i * uint64_t(stride));
    }
    draco::ExpertEncoder encoder(mesh);
    encoder.SetEncodingMethod(method);
    if (bits > 0)
        encoder.SetAttributeQuantization(
            mesh.GetNamedAttributeId(draco::GeometryAttribute::POSITION), bits);
    draco::EncoderBuffer stream;
    const draco::Status status = encoder.EncodeToBuffer(&stream);
    EXPECT_TRUE(status.ok()) << status.error_msg_string();
    return {stream.data(), stream.size()};
}

/// The file with its primitives compressed: their accessors have no bytes any more.
inline GltfFile with_draco(const GltfFile& plain, int method = draco::MESH_SEQUENTIAL_ENCODING,
                           int bits = 0) {
    GltfFile file = plain;
    for (json& mesh : file.root["meshes"])
        for (json& primitive : mesh["primitives"]) {
            json ids = json::object();
            for (const auto& [name, index] : primitive["attributes"].items()) {
                ids[name] = ids.size();
                file.root["accessors"][index.get<size_t>()].erase("bufferView");
            }
            file.root["accessors"][primitive["indices"].get<size_t>()].erase("bufferView");
            primitive["extensions"]["KHR_draco_mesh_compression"] = {
                {"bufferView", file.add_view(draco_stream(plain, primitive, method, bits))},
                {"attributes", ids}};
        }
    file.root["extensionsUsed"] = {"KHR_draco_mesh_compression"};
    file.root["extensionsRequired"] = {"KHR_draco_mesh_compression"};
    return file;
}

}  // namespace covtrace::test
