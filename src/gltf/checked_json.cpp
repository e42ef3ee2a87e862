#include "gltf/checked_json.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "core/error.h"
#include "gltf/extensions.h"
#include "scene/names.h"

namespace covtrace::gltf {
namespace {

using nlohmann::json;

/// Deepest nesting of values that is let through, because tinygltf reads them recursively.
constexpr int kMostLevels = 128;

SourceLocation location(std::string_view text, size_t byte, const std::string& name) {
    const std::string_view before = text.substr(0, std::min(byte, text.size()));
    const auto lines = std::count(before.begin(), before.end(), '\n');
    const size_t last = before.rfind('\n');
    const size_t column = last == std::string_view::npos ? before.size() : before.size() - last - 1;
    return {std::make_shared<const std::string>(name), static_cast<int>(lines) + 1,
            static_cast<int>(column) + 1};
}

/// The text in ASCII, and at most 200 characters of it.
std::string printable(std::string text) {
    for (char& c : text)
        if (c < 0x20 || c > 0x7e) c = '?';
    constexpr size_t kLongest = 200;
    return text.substr(0, kLongest);
}

/// The reason in the parser's message, without the position in front of it.
std::string reason(const std::string& what) {
    const size_t start = what.find(": ", what.find("column"));
    return printable(start == std::string::npos ? what : what.substr(start + 2));
}

/// The depth to which brackets outside of strings nest. It is measured before the parser sees the
/// text: the parser's own callback could stop it too, but then an object of n values takes a time
/// in proportion to n^2.
int deepest_level(std::string_view text) {
    int level = 0, deepest = 0;
    bool in_string = false;
    for (size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (in_string && c == '\\')
            ++i;
        else if (c == '"')
            in_string = !in_string;
        else if (!in_string && (c == '{' || c == '['))
            deepest = std::max(deepest, ++level);
        else if (!in_string && (c == '}' || c == ']'))
            --level;
    }
    return deepest;
}

json parse(std::string_view text, const std::string& name) {
    if (deepest_level(text) > kMostLevels)
        throw Error(ErrorKind::scene, name + ": its JSON is nested more than " +
                                          std::to_string(kMostLevels) + " levels deep");
    try {
        return json::parse(text.begin(), text.end());
    } catch (const json::parse_error& e) {
        const size_t byte = e.byte > 0 ? e.byte - 1 : 0;
        throw Error(ErrorKind::scene, location(text, byte, name),
                    "this is no JSON: " + reason(e.what()));
    } catch (const json::exception& e) {  // a number beyond the range of double
        throw Error(ErrorKind::scene, name + ": this is no JSON: " + reason(e.what()));
    }
}

std::optional<uint64_t> unsigned_number(const json& object, const char* key) {
    const auto it = object.find(key);
    if (it == object.end() || !it->is_number_unsigned()) return std::nullopt;
    return it->get<uint64_t>();
}

const json* element(const json& root, const char* list, std::optional<uint64_t> index) {
    const auto it = root.find(list);
    if (!index || it == root.end() || !it->is_array() || *index >= it->size()) return nullptr;
    const json& e = (*it)[*index];
    return e.is_object() ? &e : nullptr;
}

/// Checks that embedded images lie inside their buffers: tinygltf takes the address of an image
/// while it loads the file, before anyone else can check it.
void check_embedded_images(const json& root, const std::string& name) {
    const auto images = root.find("images");
    if (images == root.end() || !images->is_array()) return;
    for (size_t i = 0; i < images->size(); ++i) {
        const json& image = (*images)[i];
        if (!image.is_object() || !image.contains("bufferView")) continue;
        const json* view = element(root, "bufferViews", unsigned_number(image, "bufferView"));
        const json* buffer =
            view ? element(root, "buffers", unsigned_number(*view, "buffer")) : nullptr;
        const uint64_t size = buffer ? unsigned_number(*buffer, "byteLength").value_or(0) : 0;
        const uint64_t start = view ? unsigned_number(*view, "byteOffset").value_or(0) : 0;
        const uint64_t length = view ? unsigned_number(*view, "byteLength").value_or(0) : 0;
        constexpr uint64_t kLargest = uint64_t{1} << 31;
        if (length == 0 || length >= kLargest || start > size || length > size - start)
            throw Error(ErrorKind::scene, name + ": images[" + std::to_string(i) +
                                              "]: its bufferView does not lie inside a buffer");
    }
}

void check_version(const json& root, const std::string& name) {
    const auto asset = root.find("asset");
    std::string version;
    if (asset != root.end() && asset->is_object())
        if (const auto it = asset->find("version"); it != asset->end() && it->is_string())
            version = it->get<std::string>();
    if (version.empty())
        throw Error(ErrorKind::scene,
                    name + ": asset.version is missing; expected \"2.0\", so this is no glTF 2.0");
    if (!version.starts_with("2."))
        throw Error(ErrorKind::scene, name + ": asset.version: glTF " + in_quotes(version) +
                                          " is not supported; expected \"2.0\"");
}

/// Refuses files that require what is not read. tinygltf would call compressed ones invalid, as
/// their accessors or images have no data that it knows.
void check_extensions(const json& root, const std::string& name) {
    const auto required = root.find("extensionsRequired");
    if (required == root.end() || !required->is_array()) return;
    std::vector<std::string> missing;
    for (const json& extension : *required) {
        if (!extension.is_string()) continue;
        const auto& text = extension.get_ref<const std::string&>();
        if (!is_supported(text)) missing.push_back(printable(text));
    }
    if (missing.empty()) return;
    const bool is_one = missing.size() == 1;
    const bool has_basis = std::ranges::count(missing, "KHR_texture_basisu") > 0;
    throw Error(
        ErrorKind::scene,
        name + ": extensionsRequired: the file can't be read without the extension" +
            (is_one ? " " : "s ") + listed(missing) + ", which " + (is_one ? "is" : "are") +
            " not supported" +
            (has_basis ? "; 'gltf-transform ktxdecompress' makes PNGs of its textures" : ""));
}

}  // namespace

void check_json(std::string_view text, const std::string& name) {
    const json root = parse(text, name);
    if (!root.is_object()) throw Error(ErrorKind::scene, name + ":1:1: expected a JSON object");
    check_version(root, name);
    check_extensions(root, name);
    check_embedded_images(root, name);
}

}  // namespace covtrace::gltf
