/// Reflectances in bands of wavelengths, for light that meets two of them in any order, each many
/// times.
///
/// reflectance_powers.h has the colours of one spectrum's powers. Of two spectra there are as many
/// colours as pairs of powers; here the light keeps a share for each band, and becomes a colour
/// when it leaves.
#pragma once

#include <array>

#include "colour/illuminant_adaptation.h"
#include "core/vec.h"

namespace covtrace {

/// Values of a spectrum, one for each band.
using BandValues = std::array<float, 16>;

/// The observer in bands of 20 nanometres from 390 to 710, the outermost with all beyond them,
/// under a light. Colours of products of up to 11 saturated spectra are within 0.025 of sums over
/// all wavelengths.
class ColourBands {
  public:
    explicit ColourBands(const IlluminantAdaptation& light = {});
    /// Colour, over the light's, of the light that keeps these shares, brought into [0, 1]: no
    /// channel gains light where a product lies outside Rec.709.
    Rgb colour(const BandValues& shares) const;

  private:
    friend BandValues band_values(Rgb reflectance);
    Rgb unlimited_colour(const BandValues& shares) const;

    std::array<BandValues, 3> weights_{};  ///< by channel
};

/// The smooth spectrum (colour/sigmoid_spectrum.h) of a reflectance, brought into [0, 1]: the one
/// whose colour in the bands is the reflectance under white light. Some 50 microseconds: for load
/// time.
BandValues band_values(Rgb reflectance);

}  // namespace covtrace
