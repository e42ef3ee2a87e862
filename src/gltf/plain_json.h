/// Private to this folder: the text of a compressed file as tinygltf takes it.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace covtrace::gltf {

/// tinygltf refuses indices whose accessor has no bytes, which are those that Draco decodes to, and
/// buffers without a URI, which stand for what meshopt decodes to, and targets of animations
/// without a node, which KHR_animation_pointer has, and takes the data of WebP images for names of
/// files. Returns the JSON without such indices, with a URI of one byte for such buffers, the node
/// -1 for such targets, and such images as plain data; nothing where the text has none of them, or
/// is no JSON. `has_chunk`: the first buffer may be the binary chunk of the file.
std::optional<std::string> plain_json(std::string_view text, bool has_chunk);

}  // namespace covtrace::gltf
