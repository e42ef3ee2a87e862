/// Private to this folder: checks on the JSON that must come before the library sees it.
#pragma once

#include <string>
#include <string_view>

namespace covtrace::gltf {

/// Checks syntax (errors as `name:line:column`), nesting, that the version is 2, and that images in
/// buffers lie inside them. Throws Error(scene).
void check_json(std::string_view text, const std::string& name);

}  // namespace covtrace::gltf
