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
/// "… belongs to pbrt-v3; convert the scene with pbrt --upgrade"
Error version_three_error(const SourceLocation& where, const std::string& what);
/// What to throw for a type that is not among `known`: the above, or a list of what was expected.
Error unknown_type_error(const SourceLocation& where, const std::string& kind,
                         const std::string& name, const std::vector<std::string>& known);

}  // namespace covtrace
