/// The CIE 1931 standard observer (2 degrees).
#pragma once

namespace covtrace {

struct TristimulusValues {
    double x = 0, y = 0, z = 0;
};

/// Its colour matching functions at a wavelength (nanometres): CIE's table at every fifth from 380
/// to 780 (CIE 15:2004, table T.4; ISO 11664-1), smooth between them, within 0.0024 of the table at
/// every nanometre; 0 outside.
TristimulusValues matching_functions(double wavelength);

}  // namespace covtrace
