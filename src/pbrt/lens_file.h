/// Lens descriptions of pbrt's "realistic" camera, as far as a thin lens needs them.
#pragma once

#include <string_view>

#include "core/error.h"

namespace covtrace {

struct LensSummary {
    float focal_length = 0;       ///< millimetres, paraxial, of all elements together
    float aperture_diameter = 0;  ///< millimetres, of the stop, as far as the file opens it
    /// Diameter of the stop over that of the entrance pupil, the stop's image in front of the lens.
    float stop_per_pupil = 1;
};

/// Reads rows of four numbers, front to rear: radius of curvature (0: the aperture stop), thickness
/// to the next element, index of refraction behind it, diameter; `#` starts a comment.
///
/// Throws Error(scene) at `where` for a file with other rows or that doesn't focus.
LensSummary read_lens(std::string_view text, const std::string& name, const SourceLocation& where);

}  // namespace covtrace
