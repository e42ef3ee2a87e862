#include "gltf/codecs/draco.h"

#include <cstring>
#include <map>
#include <tuple>

#include "gltf/codecs/decoded.h"
#include "gltf/codecs/draco_mesh.h"

namespace covtrace::gltf {
namespace {

constexpr const char* kExtension = "KHR_draco_mesh_compression";

struct PrimitiveIndex {
    size_t mesh = 0, primitive = 0;
};

/// Makes accessors of one decoded mesh for the primitives that use it.
class DracoAccessors {
  public:
    DracoAccessors(Document& document, const draco::Mesh& mesh, WarningLog& log)
        : document_(document), mesh_(mesh), log_(log) {}

    /// The accessor with the mesh's triangles as indices.
    int indices(const std::string& place) {
        if (indices_ >= 0) return indices_;
        const size_t count = 3 * size_t{mesh_.num_faces()};
        spend_decoded(document_, count, sizeof(uint32_t), place);
        std::vector<unsigned char> bytes(count * sizeof(uint32_t));
        unsigned char* to = bytes.data();
        for (draco::FaceIndex f(0); f < mesh_.num_faces(); ++f)
            for (const draco::PointIndex& i : mesh_.face(f)) {
                const uint32_t index = i.value();
                std::memcpy(to, &index, sizeof index);
                to += sizeof index;
            }
        tinygltf::Accessor accessor;
        accessor.type = TINYGLTF_TYPE_SCALAR;
        accessor.componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
        return indices_ = add(std::move(accessor), std::move(bytes), count);
    }

    /// The accessor with the values of the attribute `id`, in the form of accessors[like].
    int attribute(int like, uint32_t id, const std::string& place) {
        const tinygltf::Accessor& form =
            at(document_, document_.model.accessors, like, "accessors", place);
        const auto key = std::tuple(id, form.componentType, form.type, form.normalized);
        const auto [entry, is_new] = attributes_.try_emplace(key, -1);
        if (!is_new) return entry->second;
        const draco::PointAttribute* values = mesh_.GetAttributeByUniqueId(id);
        if (!values)
            document_.refuse(place, "the compressed mesh has no attribute " + std::to_string(id));
        if (values->num_components() !=
            tinygltf::GetNumComponentsInType(static_cast<uint32_t>(form.type)))
            document_.refuse(place, "the compressed attribute has " +
                                        std::to_string(values->num_components()) +
                                        " components, another number than its accessor");
        if (form.count != mesh_.num_points())
            log_.add(document_.place(place),
                     "its accessor is said to have another number of elements than the compressed "
                     "mesh has vertices, which count");
        return entry->second = convert(form, *values, place);
    }

  private:
    int convert(tinygltf::Accessor form, const draco::PointAttribute& values,
                const std::string& place) {
        switch (form.componentType) {
            case TINYGLTF_COMPONENT_TYPE_BYTE:
                return convert_to<int8_t>(std::move(form), values, place);
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
                return convert_to<uint8_t>(std::move(form), values, place);
            case TINYGLTF_COMPONENT_TYPE_SHORT:
                return convert_to<int16_t>(std::move(form), values, place);
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
                return convert_to<uint16_t>(std::move(form), values, place);
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
                return convert_to<uint32_t>(std::move(form), values, place);
            case TINYGLTF_COMPONENT_TYPE_FLOAT:
                return convert_to<float>(std::move(form), values, place);
            default:
                document_.refuse(place, "the component type of its accessor, " +
                                            std::to_string(form.componentType) +
                                            ", is none of an attribute");
        }
    }

    template <typename T>
    int convert_to(tinygltf::Accessor form, const draco::PointAttribute& values,
                   const std::string& place) {
        const size_t components = values.num_components();
        const size_t element = components * sizeof(T), count = mesh_.num_points();
        spend_decoded(document_, count, element, place);
        std::vector<unsigned char> bytes(count * element);
        std::vector<T> value(components);
        for (size_t i = 0; i < count; ++i) {
            const draco::PointIndex point(static_cast<uint32_t>(i));
            if (!values.ConvertValue<T>(values.mapped_index(point), value.data()))
                document_.refuse(place, "value " + std::to_string(i) +
                                            " does not fit into the type of its accessor");
            std::memcpy(bytes.data() + i * element, value.data(), element);
        }
        return add(std::move(form), std::move(bytes), count);
    }

    /// Adds an accessor that has these bytes to itself.
    int add(tinygltf::Accessor accessor, std::vector<unsigned char> bytes, size_t count) {
        tinygltf::BufferView view;
        view.byteLength = bytes.size();
        view.buffer = add_buffer(document_, std::move(bytes));
        document_.model.bufferViews.push_back(std::move(view));
        accessor.bufferView = static_cast<int>(document_.model.bufferViews.size() - 1);
        accessor.byteOffset = 0;
        accessor.count = count;
        accessor.sparse = {};
        document_.model.accessors.push_back(std::move(accessor));
        return static_cast<int>(document_.model.accessors.size() - 1);
    }

    Document& document_;
    const draco::Mesh& mesh_;
    WarningLog& log_;
    int indices_ = -1;
    std::map<std::tuple<uint32_t, int, int, bool>, int> attributes_;
};

/// The bytes of a buffer view.
std::span<const unsigned char> view_bytes(const Document& document, int index,
                                          const std::string& place) {
    const auto& view = at(document, document.model.bufferViews, index, "bufferViews", place);
    return buffer_bytes(document, view.buffer, view.byteOffset, view.byteLength,
                        element("bufferViews", static_cast<size_t>(index)));
}

/// The place of a primitive's extension, and the extension's object.
std::pair<std::string, tinygltf::Value> extension_of(const Document& document, PrimitiveIndex at) {
    const auto& primitive = document.model.meshes[at.mesh].primitives[at.primitive];
    return {element("meshes", at.mesh) + "." + element("primitives", at.primitive) +
                ".extensions." + kExtension,
            *extension(primitive.extensions, kExtension)};
}

void use(Document& document, PrimitiveIndex index, DracoAccessors& accessors) {
    const auto [place, object] = extension_of(document, index);
    std::map<std::string, int> decoded;
    const auto& named = document.model.meshes[index.mesh].primitives[index.primitive].attributes;
    if (object.Has("attributes") && object.Get("attributes").IsObject()) {
        const tinygltf::Value& ids = object.Get("attributes");
        for (const auto& [name, accessor] : named)
            if (ids.Has(name)) {
                const std::string here = place + ".attributes";
                const uint64_t id = whole_number(document, ids, name.c_str(), here);
                decoded[name] =
                    accessors.attribute(accessor, static_cast<uint32_t>(id), here + "." + name);
            }
    }
    const int indices = accessors.indices(place);
    auto& primitive = document.model.meshes[index.mesh].primitives[index.primitive];
    for (const auto& [name, accessor] : decoded) primitive.attributes[name] = accessor;
    // The library gives triangles, in strips too.
    primitive.indices = indices;
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
}

}  // namespace

void decode_draco(Document& document, WarningLog& log) {
    // Primitives that differ in their material share a mesh: it is decoded once.
    std::map<int, std::vector<PrimitiveIndex>> users;
    for (size_t m = 0; m < document.model.meshes.size(); ++m)
        for (size_t p = 0; p < document.model.meshes[m].primitives.size(); ++p) {
            if (!extension(document.model.meshes[m].primitives[p].extensions, kExtension)) continue;
            const auto [place, object] = extension_of(document, {m, p});
            const uint64_t view = whole_number(document, object, "bufferView", place);
            const int mode = document.model.meshes[m].primitives[p].mode;
            if (mode >= 0 && mode != TINYGLTF_MODE_TRIANGLES &&
                mode != TINYGLTF_MODE_TRIANGLE_STRIP)
                document.refuse(place, "only triangles and strips of them may be compressed");
            users[static_cast<int>(view)].push_back({m, p});
        }
    for (const auto& [view, primitives] : users) {
        const std::string place = extension_of(document, primitives.front()).first;
        const auto bytes = view_bytes(document, view, place + ".bufferView");
        const DracoResult result =
            decode_draco_mesh(bytes, document.decoded.left(), document.place(place));
        spend_decoded(document, result.is_too_large ? document.decoded.left() + 1 : result.bytes, 1,
                      place);
        if (!result.mesh) document.refuse(place, "it can't be decoded: " + result.error);
        DracoAccessors accessors(document, *result.mesh, log);
        for (const PrimitiveIndex& p : primitives) use(document, p, accessors);
    }
}

}  // namespace covtrace::gltf
