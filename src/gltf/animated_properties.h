/// Private to this folder: what KHR_animation_pointer moves beside the poses of nodes.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gltf/channel.h"
#include "gltf/document.h"

namespace covtrace::gltf {

/// The names and numbers of a JSON pointer (RFC 6901), "/materials/0" as {"materials", "0"}; empty
/// where the text is no pointer.
std::vector<std::string> pointer_path(const std::string& pointer);
/// A pointer for messages, with its end, which tells what is meant.
std::string pointer_in_quotes(const std::string& pointer);

/// The number that a part of a pointer is; none where it is another name, or not below `count`.
std::optional<size_t> pointer_index(const std::string& part, size_t count);

/// The JSON of what Document::properties keeps; empty where nothing of the file can be animated so.
std::string json_of_properties(std::string_view json);

/// Properties of materials, lights and cameras, weights of meshes, single weights of nodes and the
/// visibility of nodes, over time.
class AnimatedProperties {
  public:
    /// Whether a pointer names such a property of the document.
    static bool has(const Document& document, const std::vector<std::string>& path);
    /// The kind of such a property's values.
    static ValueKind kind_of(const std::vector<std::string>& path);
    /// Adds a channel of a property that the document has; returns whether it is the first one.
    bool add(const std::vector<std::string>& path, Channel channel);

    bool empty() const { return channels_.empty(); }
    /// Time of the first and of the last key; there must be a channel.
    std::array<float, 2> span() const;
    /// Gives the document the values at a time in seconds; where a property has another number of
    /// numbers it stays, with a warning. Throws Error(scene) where a property cannot have what the
    /// animation gives it.
    void apply(double time, Document& document, WarningLog& log) const;

  private:
    std::map<std::vector<std::string>, Channel> channels_;
};

}  // namespace covtrace::gltf
