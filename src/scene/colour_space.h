/// The colour spaces of pbrt's `ColorSpace` directive, in which `rgb` parameters are given.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/vec.h"

namespace covtrace {

enum class ColourSpace { srgb, dci_p3, rec2020, aces2065_1 };

std::optional<ColourSpace> colour_space_named(std::string_view name);
const std::vector<std::string>& colour_space_names();
/// Linear Rec.709 of a linear colour in `from`; white stays white (Bradford's adaptation from D60
/// for ACES). Colours outside of the Rec.709 gamut get negative components.
Rgb to_rec709(Rgb c, ColourSpace from);

}  // namespace covtrace
