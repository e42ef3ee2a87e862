/// Recognises pbrt-v3 files, which look much like version 4 but mean other things.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"

namespace covtrace {

/// True for names of entities that only version 3 had; `kind` as in messages ("material", "shape",
/// …).
bool is_version_three_name(std::string_view kind, std::string_view name);
/// The error that `what` belongs to pbrt-v3, with the command that converts the scene.
Error version_three_error(const SourceLocation& where, const std::string& what);
/// The error for a type that is not among `known`: that it belongs to pbrt-v3, or a list of the
/// known ones.
Error unknown_type_error(const SourceLocation& where, const std::string& kind,
                         const std::string& name, const std::vector<std::string>& known);

}  // namespace covtrace
