#include "gltf/codecs/draco_mesh.h"

#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/core/varint_decoding.h>

#include <algorithm>
#include <exception>
#include <optional>
#include <type_traits>

#include "core/memory_limit.h"

namespace covtrace::gltf {
namespace {

/// Bytes of a face: three indices. As many take the connectivity of each attribute that has seams
/// of its own.
constexpr uint64_t kFace = 3 * sizeof(uint32_t);
/// Bytes held while decoding for each byte of the mesh: 270 MB were for a grid of two million
/// triangles with normals and texture coordinates, which takes 110 MB.
constexpr uint64_t kWork = 3;

/// One of the library's decoders that looks at the counts in a stream before room is made for them.
template <typename Decoder>
class BoundedDecoder : public Decoder {
  public:
    BoundedDecoder(uint64_t most, const SourceLocation& where) : most_(most), where_(where) {}

    uint64_t bytes() const { return bytes_; }
    bool is_too_large() const { return is_too_large_; }
    /// Throws what stopped the decoder: the library has no way to hand it on.
    void rethrow() const {
        if (failure_) std::rethrow_exception(failure_);
    }

  protected:
    bool DecodeConnectivity() override {
        draco::DecoderBuffer ahead = *this->buffer();
        uint32_t first = 0, second = 0;
        if (!draco::DecodeVarint(&first, &ahead) || !draco::DecodeVarint(&second, &ahead))
            return false;
        constexpr bool kPointsFirst = std::is_same_v<Decoder, draco::MeshEdgebreakerDecoder>;
        const uint64_t points = kPointsFirst ? first : second;
        const uint64_t faces = kPointsFirst ? second : first;
        uint8_t seams = 0;  // attributes with their own
        if (kPointsFirst && !ahead.Decode(&seams)) return false;
        // No more points than corners: else their number would be bounded by nothing.
        if (points > 3 * faces || !take(faces, kFace * (1 + uint64_t{seams}))) return false;
        return Decoder::DecodeConnectivity();
    }

    bool DecodeAllAttributes() override {
        const draco::PointCloud& cloud = *this->point_cloud();
        uint64_t point = 0;
        for (int i = 0; i < cloud.num_attributes(); ++i) {
            const draco::PointAttribute& a = *cloud.attribute(i);
            // Beside the values the integers that they are made of.
            point += static_cast<uint64_t>(a.byte_stride()) + sizeof(int32_t) * a.num_components();
        }
        return take(cloud.num_points(), point) && Decoder::DecodeAllAttributes();
    }

  private:
    /// Counts the bytes; false where they are too many.
    bool take(uint64_t count, uint64_t size) {
        is_too_large_ = size > 0 && count > (most_ - bytes_) / size;
        if (is_too_large_) return false;
        bytes_ += count * size;
        try {
            room_.emplace(kWork * bytes_, "the mesh's bytes", where_);
        } catch (...) {
            failure_ = std::current_exception();
            return false;
        }
        return true;
    }

    uint64_t most_, bytes_ = 0;
    bool is_too_large_ = false;
    SourceLocation where_;
    std::optional<MemoryReservation> room_;
    std::exception_ptr failure_;
};

/// Whether faces name points, and points values, that are there. The library does not look.
bool is_consistent(const draco::Mesh& mesh) {
    const uint32_t points = mesh.num_points();
    for (draco::FaceIndex f(0); f < mesh.num_faces(); ++f)
        for (const draco::PointIndex& i : mesh.face(f))
            if (i.value() >= points) return false;
    for (int k = 0; k < mesh.num_attributes(); ++k) {
        const draco::PointAttribute& a = *mesh.attribute(k);
        if (a.byte_offset() < 0 || a.byte_stride() < 0 || !a.buffer()) return false;
        const auto offset = static_cast<uint64_t>(a.byte_offset());
        const auto stride = static_cast<uint64_t>(a.byte_stride());
        const uint64_t held = a.buffer()->data_size();
        if (stride <
                static_cast<uint64_t>(draco::DataTypeLength(a.data_type())) * a.num_components() ||
            offset > held || a.size() > (held - offset) / std::max(stride, uint64_t{1}))
            return false;
        if (a.is_mapping_identity()) {
            if (a.size() < points) return false;
            continue;
        }
        if (a.indices_map_size() < points) return false;
        for (draco::PointIndex i(0); i < points; ++i)
            if (a.mapped_index(i).value() >= a.size()) return false;
    }
    return true;
}

template <typename Decoder>
DracoResult decode_with(draco::DecoderBuffer& buffer, uint64_t most, const SourceLocation& where) {
    DracoResult result;
    auto mesh = std::make_unique<draco::Mesh>();
    BoundedDecoder<Decoder> decoder(most, where);
    const draco::Status status = decoder.Decode(draco::DecoderOptions(), &buffer, mesh.get());
    decoder.rethrow();
    result.bytes = decoder.bytes();
    result.is_too_large = decoder.is_too_large();
    if (result.is_too_large)
        result.error = "it is too large";
    else if (!status.ok())
        result.error = status.error_msg_string();
    else if (!is_consistent(*mesh))
        result.error = "it names points or values that are not there";
    else
        result.mesh = std::move(mesh);
    return result;
}

}  // namespace

DracoResult decode_draco_mesh(std::span<const unsigned char> bytes, uint64_t most,
                              const SourceLocation& where) {
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    draco::DecoderBuffer ahead = buffer;
    draco::DracoHeader header;
    DracoResult result;
    const draco::Status status = draco::PointCloudDecoder::DecodeHeader(&ahead, &header);
    if (!status.ok()) {
        result.error = status.error_msg_string();
    } else if (header.version_major != 2 || header.version_minor != 2) {
        // Older streams have decoders of their own in the library, with fewer checks.
        result.error = "it is of version " + std::to_string(header.version_major) + "." +
                       std::to_string(header.version_minor) + "; expected 2.2";
    } else if (header.encoder_type != draco::TRIANGULAR_MESH) {
        result.error = "it holds no triangles";
    } else if (header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING) {
        return decode_with<draco::MeshEdgebreakerDecoder>(buffer, most, where);
    } else if (header.encoder_method == draco::MESH_SEQUENTIAL_ENCODING) {
        return decode_with<draco::MeshSequentialDecoder>(buffer, most, where);
    } else {
        result.error = "its method " + std::to_string(header.encoder_method) + " is not known";
    }
    return result;
}

}  // namespace covtrace::gltf
