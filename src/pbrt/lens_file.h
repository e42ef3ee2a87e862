/// Lens descriptions of pbrt's "realistic" camera.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "scene/lens_description.h"

namespace covtrace {

/// Reads rows of four numbers, front to rear, in millimetres: radius of curvature (0: the aperture
/// stop), thickness to the next element, index of refraction behind it (0: that of air), diameter;
/// `#` starts a comment. Returns the surfaces in metres. Throws Error(scene) at `where` for a file
/// with other rows or that doesn't focus.
std::vector<LensSurface> read_lens(std::string_view text, const std::string& name,
                                   const SourceLocation& where);

}  // namespace covtrace
