/// The colour spaces of pbrt's `ColorSpace` directive, in which `rgb` parameters and the pixels of
/// EXR files are given.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/vec.h"

namespace covtrace {

enum class ColourSpace { srgb, dci_p3, rec2020, aces2065_1 };

/// The space of a name, in capitals or not, as in pbrt-v4.
std::optional<ColourSpace> colour_space_named(std::string_view name);
const std::vector<std::string>& colour_space_names();
/// Chromaticities of a colour space: CIE 1931 x and y of red, green, blue and white, one after the
/// other, as in an EXR's attribute "chromaticities".
using Chromaticities = std::array<float, 8>;
/// The space with these primaries and this white, each coordinate within a thousandth of itself or
/// 0.0001, as pbrt-v4 allows but for primaries next to zero.
std::optional<ColourSpace> colour_space_with(const Chromaticities& c);
/// Converts a linear colour in `from` to linear Rec.709; white stays white (Bradford's adaptation
/// from D60 for ACES). Colours outside of the Rec.709 gamut get negative components.
Rgb to_rec709(Rgb c, ColourSpace from);
/// Converts as to_rec709 and cuts negative results to 0; a colour that is in Rec.709 stays as it
/// is.
Rgb clipped_to_rec709(Rgb c, ColourSpace from);

}  // namespace covtrace
