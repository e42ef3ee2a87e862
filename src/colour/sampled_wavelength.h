/// Wavelengths chosen at random for paths that a dispersive glass parts by colour.
#pragma once

#include "core/vec.h"

namespace covtrace {

/// One wavelength in place of white light.
struct SampledWavelength {
    float nanometres = 0;
    /// Colour that light of this wavelength adds to white light under D65, over the density of the
    /// choice: its mean is (1, 1, 1). Channels are negative where the wavelength's colour lies
    /// outside of Rec.709.
    Rgb weight{1};
};

/// A wavelength of visible light for `u`, uniform in [0, 1). Wavelengths are chosen by the sum of
/// what they add to the three channels, or take from them.
SampledWavelength sample_wavelength(float u);

}  // namespace covtrace
