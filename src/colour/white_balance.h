/// White balance of a camera as a matrix on colours.
#pragma once

#include <array>

namespace covtrace {

/// Matrix from linear Rec.709 to linear Rec.709 such that daylight of this correlated colour
/// temperature (kelvin, > 0; a black body below 4000 K) becomes white: the Bradford adaptation to
/// D65, as pbrt-v4's sensor "cie1931" applies it.
std::array<std::array<float, 3>, 3> white_balance(float kelvin);
/// Matrix from the colours that it gives to the XYZ of what it was given.
std::array<std::array<float, 3>, 3> xyz_before_balance(float kelvin);

}  // namespace covtrace
