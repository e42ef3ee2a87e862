/// Daylight of a correlated colour temperature, as a white balance names it.
#pragma once

#include "colour/matrix3.h"
#include "colour/spectrum.h"

namespace covtrace {

/// White point, as XYZ with Y = 1, of daylight of this temperature (kelvin, > 0; CIE 15:2004,
/// section 3.1), or of a black body below 4000 K, where daylight is not defined. The temperature
/// is that of before the radiation constant c2 changed, as in "D65" of 6500 K.
Triple daylight_white(double kelvin);
/// Its spectrum, of any size (CIE 15:2004, section 3.1 and table T.2).
Spectrum daylight_spectrum(double kelvin);

}  // namespace covtrace
