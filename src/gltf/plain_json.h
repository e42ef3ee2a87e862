/// Private to this folder: the text of a file as tinygltf takes it.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace covtrace::gltf {

/// tinygltf refuses indices whose accessor has no bytes, which are those that Draco decodes to, and
/// buffers without a URI, which stand for what meshopt decodes to, and takes the data of WebP
/// images for names of files; it also asks for what is optional in glTF 2.0, the inverse bind
/// matrices of skins and the nodes of animated channels. Returns the JSON without such indices,
/// with a URI of one byte for such buffers, such images as plain data, and -1 for what it asks for;
/// nothing where the text has none of them, or is no JSON. `has_chunk`: the first buffer may be the
/// binary chunk of the file.
std::optional<std::string> plain_json(std::string_view text, bool has_chunk);

}  // namespace covtrace::gltf
