#include "gltf/animated_properties.h"

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>
#include <utility>

#include "scene/names.h"

namespace covtrace::gltf {
namespace {

using nlohmann::json;
using Path = std::vector<std::string>;

constexpr const char* kLights = "KHR_lights_punctual";
constexpr const char* kVisibility = "KHR_node_visibility";

/// Whether a path is {list, an index of it, and a property}.
bool is_element(const Path& path, const char* list, size_t count) {
    return path.size() >= 3 && path[0] == list && pointer_index(path[1], count);
}

bool is_light(const Document& document, const Path& path) {
    return path.size() >= 5 && path[0] == "extensions" && path[1] == kLights &&
           path[2] == "lights" && pointer_index(path[3], document.model.lights.size());
}

/// Whether a path is the texture of a material, or leads through one, that is not there.
bool lacks_texture(const tinygltf::Material& material, const Path& path) {
    const bool is_of_extension = path[2] == "extensions" && path.size() > 4;
    const auto part = std::find_if(path.begin() + 2, path.end(),
                                   [](const std::string& p) { return p.ends_with("Texture"); });
    if (part == path.end()) return false;
    if (is_of_extension) {
        const tinygltf::Value* own = extension(material.extensions, path[3].c_str());
        return !own || !own->Has(*part);
    }
    const auto& base = material.pbrMetallicRoughness;
    const std::pair<const char*, int> indices[] = {
        {"baseColorTexture", base.baseColorTexture.index},
        {"metallicRoughnessTexture", base.metallicRoughnessTexture.index},
        {"normalTexture", material.normalTexture.index},
        {"occlusionTexture", material.occlusionTexture.index},
        {"emissiveTexture", material.emissiveTexture.index}};
    return std::ranges::none_of(indices,
                                [&](const auto& t) { return t.first == *part && t.second >= 0; });
}

bool is_of_material(const Document& document, const Path& path) {
    const auto& materials = document.model.materials;
    return is_element(path, "materials", materials.size()) &&
           !lacks_texture(materials[*pointer_index(path[1], materials.size())], path);
}

/// Whether a path is all weights of a mesh or one of them.
bool is_weights_of_mesh(const Document& document, const Path& path) {
    const auto& meshes = document.model.meshes;
    if (!is_element(path, "meshes", meshes.size()) || path[2] != "weights") return false;
    if (path.size() == 3) return true;
    const auto& primitives = meshes[*pointer_index(path[1], meshes.size())].primitives;
    return path.size() == 4 && !primitives.empty() &&
           pointer_index(path[3], primitives[0].targets.size());
}

/// Whether a path is one of the weights that a node has of its own.
bool is_weight_of_node(const Document& document, const Path& path) {
    const auto& nodes = document.model.nodes;
    return path.size() == 4 && is_element(path, "nodes", nodes.size()) && path[2] == "weights" &&
           pointer_index(path[3], nodes[*pointer_index(path[1], nodes.size())].weights.size());
}

/// Sets all weights, or the one that the path ends with.
void set_weights(std::vector<double>& weights, const Path& path, const std::vector<double>& value) {
    if (path.size() == 3) {
        weights = value;
        return;
    }
    const size_t i = pointer_index(path[3], SIZE_MAX).value_or(0);
    if (weights.size() <= i) weights.resize(i + 1);
    weights[i] = value[0];
}

bool is_visibility(const Document& document, const Path& path) {
    return path.size() == 5 && is_element(path, "nodes", document.model.nodes.size()) &&
           path[2] == "extensions" && path[3] == kVisibility && path[4] == "visible";
}

bool is_true(const std::vector<double>& value) {
    return value[0] >= 0.5;  // outputs of animations are numbers
}

/// How many numbers a property has that a file leaves at its default.
size_t default_size(const Path& path) {
    const std::string &name = path.back(), &parent = path[path.size() - 2];
    if (name == "specularFactor") return parent == "KHR_materials_pbrSpecularGlossiness" ? 3 : 1;
    if (name == "scale" || name == "offset") return parent == "KHR_texture_transform" ? 2 : 1;
    if (name == "baseColorFactor" || name == "diffuseFactor") return 4;
    const bool is_colour = name == "color" || name == "emissiveFactor" ||
                           name.ends_with("ColorFactor") || name == "attenuationColor";
    return is_colour ? 3 : 1;
}

/// How many numbers what a path names has; none where that is not of numbers.
std::optional<size_t> size_of(const json& root, const Path& path) {
    const json* place = &root;
    for (const std::string& part : path) {
        if (place->is_array()) {
            const auto index = pointer_index(part, place->size());
            if (!index) return std::nullopt;
            place = &(*place)[*index];
        } else if (place->is_object() && place->contains(part)) {
            place = &(*place)[part];
        } else if (place->is_object() || place->is_null()) {
            return default_size(path);
        } else {
            return std::nullopt;
        }
    }
    if (place->is_array()) return place->size();
    if (place->is_number() || place->is_boolean()) return 1;
    return std::nullopt;
}

/// Sets what a path names, which has as many numbers as the value; objects that are not there are
/// made.
void set(json& root, const Path& path, const std::vector<double>& value) {
    json* place = &root;
    for (const std::string& part : path)
        place =
            place->is_array() ? &(*place)[*pointer_index(part, place->size())] : &(*place)[part];
    if (place->is_boolean())
        *place = is_true(value);
    else if (value.size() == 1 && !place->is_array())
        *place = value[0];
    else
        *place = value;
}

std::string text_of(const Path& path) {
    std::string text;
    for (const std::string& part : path) text += '/' + part;
    return pointer_in_quotes(text);
}

/// Reads the JSON of the properties into the document, by the library that has read the whole.
void read_properties(const std::string& text, Document& document) {
    tinygltf::TinyGLTF library;
    tinygltf::Model read;
    std::string error, warning;
    const bool parsed = library.LoadASCIIFromString(&read, &error, &warning, text.data(),
                                                    static_cast<unsigned>(text.size()), "");
    if (!parsed || !error.empty() || read.materials.size() != document.model.materials.size() ||
        read.cameras.size() != document.model.cameras.size() ||
        read.lights.size() != document.model.lights.size())
        document.refuse("animations",
                        "KHR_animation_pointer gives a material, camera or light a value that it "
                        "cannot have");
    document.model.materials = std::move(read.materials);
    document.model.cameras = std::move(read.cameras);
    document.model.lights = std::move(read.lights);
}

}  // namespace

std::vector<std::string> pointer_path(const std::string& pointer) {
    Path path;
    if (!pointer.starts_with('/')) return path;
    for (size_t i = 0; i < pointer.size(); ++i) {
        const bool is_escaped = pointer[i] == '~' && i + 1 < pointer.size();
        if (pointer[i] == '/') {
            path.emplace_back();
        } else if (is_escaped && (pointer[i + 1] == '0' || pointer[i + 1] == '1')) {
            path.back() += pointer[++i] == '0' ? '~' : '/';
        } else {
            path.back() += pointer[i];
        }
    }
    return path;
}

std::string pointer_in_quotes(const std::string& pointer) {
    constexpr size_t kLongest = 160;  // textures' transforms have 100, and end with what tells most
    return in_quotes(pointer, kLongest);
}

std::optional<size_t> pointer_index(const std::string& part, size_t count) {
    size_t index = 0;
    const char* end = part.data() + part.size();
    const auto [rest, error] = std::from_chars(part.data(), end, index);
    if (error != std::errc() || rest != end || index >= count) return std::nullopt;
    return index;
}

std::string json_of_properties(std::string_view text) {
    if (text.find("KHR_animation_pointer") == text.npos) return {};
    const json root = json::parse(text.begin(), text.end(), nullptr, false);
    json properties = {{"asset", {{"version", "2.0"}}}};
    for (const char* list : {"materials", "cameras"})
        if (root.is_object() && root.contains(list)) properties[list] = root[list];
    const json::json_pointer lights(std::string("/extensions/") + kLights);
    if (root.is_object() && root.contains(lights)) properties[lights] = root[lights];
    return properties.dump();
}

bool AnimatedProperties::has(const Document& document, const Path& path) {
    constexpr size_t kDeepest = 32;  // more parts than extensions of extensions have
    if (path.size() > kDeepest) return false;
    return is_of_material(document, path) ||
           is_element(path, "cameras", document.model.cameras.size()) || is_light(document, path) ||
           is_weights_of_mesh(document, path) || is_weight_of_node(document, path) ||
           is_visibility(document, path);
}

ValueKind AnimatedProperties::kind_of(const Path& path) {
    // Weights, ways and sizes on textures, heights of bumps and turns
    for (const char* name : {"offset", "rotation", "scale", "anisotropyRotation"})
        if (path.back() == name) return ValueKind::any;
    return path[2] == "weights" ? ValueKind::any : ValueKind::positive;
}

bool AnimatedProperties::add(const Path& path, Channel channel) {
    return channels_.emplace(path, std::move(channel)).second;
}

std::array<float, 2> AnimatedProperties::span() const {
    std::array<float, 2> span = channels_.begin()->second.span();
    for (const auto& [path, channel] : channels_) {
        span[0] = std::min(span[0], channel.span()[0]);
        span[1] = std::max(span[1], channel.span()[1]);
    }
    return span;
}

void AnimatedProperties::apply(double time, Document& document, WarningLog& log) const {
    if (channels_.empty()) return;
    json properties = json::parse(document.properties);
    for (const auto& [path, channel] : channels_) {
        const std::vector<double> value = channel.at(time);
        const size_t index = pointer_index(path[1], SIZE_MAX).value_or(0);
        if (is_weights_of_mesh(document, path))
            set_weights(document.model.meshes[index].weights, path, value);
        else if (is_weight_of_node(document, path))
            set_weights(document.model.nodes[index].weights, path, value);
        else if (is_visibility(document, path))
            document.model.nodes[index].extensions[kVisibility] = tinygltf::Value(
                tinygltf::Value::Object{{"visible", tinygltf::Value(is_true(value))}});
        else if (size_of(properties, path) == value.size())
            set(properties, path, value);
        else
            log.add(document.place("animations"),
                    "what KHR_animation_pointer moves here rests: " + text_of(path) +
                        " cannot have values of " + std::to_string(value.size()) +
                        (value.size() == 1 ? " number" : " numbers"));
    }
    read_properties(properties.dump(), document);
}

}  // namespace covtrace::gltf
