#include "gltf/plain_json.h"

#include <nlohmann/json.hpp>

namespace covtrace::gltf {
namespace {

using nlohmann::json;

constexpr std::string_view kWebpData = "data:image/webp;base64,";
constexpr const char* kDraco = "KHR_draco_mesh_compression";
constexpr const char* kMeshopt = "meshopt_compression";  ///< behind EXT_ or KHR_

/// The value of a key, null where there is none or `object` is no object.
json* value(json& object, const char* key) {
    if (!object.is_object()) return nullptr;
    const auto it = object.find(key);
    return it == object.end() ? nullptr : &*it;
}

/// Calls visit(element, its index) for all elements of a list that are objects.
template <typename Visit>
void visit_objects(json* list, Visit visit) {
    if (!list || !list->is_array()) return;
    for (size_t i = 0; i < list->size(); ++i)
        if ((*list)[i].is_object()) visit((*list)[i], i);
}

/// The object of either meshopt extension.
json* meshopt_extension(json& object) {
    json* extensions = value(object, "extensions");
    if (!extensions) return nullptr;
    for (const char* prefix : {"EXT_", "KHR_"}) {
        json* found = value(*extensions, (std::string(prefix) + kMeshopt).c_str());
        if (found && found->is_object()) return found;
    }
    return nullptr;
}

/// Removes the indices that Draco's triangles take the place of.
void remove_draco_indices(json& root) {
    visit_objects(value(root, "meshes"), [](json& mesh, size_t) {
        visit_objects(value(mesh, "primitives"), [](json& primitive, size_t) {
            json* extensions = value(primitive, "extensions");
            json* draco = extensions ? value(*extensions, kDraco) : nullptr;
            if (draco && draco->is_object()) primitive.erase("indices");
        });
    });
}

/// Gives a URI to the buffers without one that stand for what meshopt decodes to.
void fill_placeholders(json& root, bool has_chunk) {
    json* buffers = value(root, "buffers");
    if (!buffers || !buffers->is_array()) return;
    std::vector<bool> is_decoded(buffers->size());
    visit_objects(buffers, [&](json& buffer, size_t i) {
        if (meshopt_extension(buffer)) is_decoded[i] = true;
    });
    visit_objects(value(root, "bufferViews"), [&](json& view, size_t) {
        const json* index = value(view, "buffer");
        if (meshopt_extension(view) && index && index->is_number_unsigned() &&
            index->get<uint64_t>() < is_decoded.size())
            is_decoded[index->get<uint64_t>()] = true;
    });
    visit_objects(buffers, [&](json& buffer, size_t i) {
        if (!is_decoded[i] || buffer.contains("uri") || (has_chunk && i == 0)) return;
        buffer["uri"] = "data:application/octet-stream;base64,AA==";
        buffer["byteLength"] = 1;
    });
}

/// Gives WebP images in the text the type that stands for any.
void rename_webp_data(json& root) {
    visit_objects(value(root, "images"), [](json& image, size_t) {
        json* uri = value(image, "uri");
        if (!uri || !uri->is_string()) return;
        auto& text = uri->get_ref<std::string&>();
        if (text.starts_with(kWebpData))
            text.replace(0, kWebpData.size(), "data:application/octet-stream;base64,");
    });
}

/// Gives skins without inverse bind matrices and channels without a node the index -1, which stands
/// for none: glTF 2.0 has both optional, the library has not. Returns whether there were any.
bool fill_optional_indices(json& root) {
    bool has_filled = false;
    const auto fill = [&](json& object, const char* key) {
        if (object.contains(key)) return;
        object[key] = -1;
        has_filled = true;
    };
    visit_objects(value(root, "skins"),
                  [&](json& skin, size_t) { fill(skin, "inverseBindMatrices"); });
    visit_objects(value(root, "animations"), [&](json& animation, size_t) {
        visit_objects(value(animation, "channels"), [&](json& channel, size_t) {
            json* target = value(channel, "target");
            if (target && target->is_object()) fill(*target, "node");
        });
    });
    return has_filled;
}

}  // namespace

std::optional<std::string> plain_json(std::string_view text, bool has_chunk) {
    const auto holds = [&](std::string_view word) { return text.find(word) != text.npos; };
    const bool is_encoded = holds(kDraco) || holds(kMeshopt) || holds("webp");
    if (!is_encoded && !holds("\"skins\"") && !holds("\"animations\"")) return std::nullopt;
    json root = json::parse(text.begin(), text.end(), nullptr, false);
    if (!root.is_object()) return std::nullopt;
    if (!fill_optional_indices(root) && !is_encoded) return std::nullopt;
    remove_draco_indices(root);
    fill_placeholders(root, has_chunk);
    rename_webp_data(root);
    return root.dump();
}

}  // namespace covtrace::gltf
