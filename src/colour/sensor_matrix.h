/// The sensor of a camera, as matrices on the colours of an image.
#pragma once

#include <array>
#include <vector>

#include "colour/matrix3.h"
#include "colour/sensor_curves.h"
#include "core/vec.h"

namespace covtrace {

/// A sensor as it shows light.
struct SensorMatrices {
    /// From linear Rec.709 to linear Rec.709 as the sensor shows it.
    std::array<std::array<float, 3>, 3> shown;
    /// From the shown colour to the sensor's three values, in pbrt's units: the integrals, over
    /// nanometres, of its curves times light whose integral with CIE's y is its luminance.
    std::array<std::array<float, 3>, 3> values;
};

/// The matrices of a sensor, balanced for daylight of this correlated colour temperature (kelvin,
/// > 0; a black body below 4000 K).
///
/// pbrt-v4 integrates light with the sensor's curves and brings the result to XYZ by a matrix,
/// fitted to the patches of a colour checker: under the light of the balance they shall look as the
/// standard observer sees them under D65. Here the image has colours in place of spectra, so a
/// matrix takes the place of the curves, too. It is fitted to the spectra that colours come from:
/// the patches, and the smooth ones of colour/sigmoid_spectrum.h, each under D65 and under the
/// light of the balance, and to black bodies. Both lights themselves are within 1 % of pbrt's. How
/// far single colours are from the spectral result is in
/// docs/decisions/0100-sensors-as-matrices.md.
SensorMatrices sensor_matrices(const SensorCurves& sensor, float kelvin);

/// Colours of black bodies for images that a sensor shows. A matrix on the standard observer's
/// colours can't be exact for all light: blue of a fire, small beside its red, comes out too dark.
/// With the colours from here the sensor shows light itself as pbrt-v4 shows its spectrum.
class SensorLight {
  public:
    SensorLight(const SensorCurves& sensor, const SensorMatrices& matrices);
    /// The colour, linear Rec.709 before `shown`, of light of luminance 1 from a black body at a
    /// temperature (kelvin, > 0), as emission_colour(blackbody_spectrum(kelvin)) is for the
    /// standard observer; negative components are set to 0.
    Rgb blackbody_colour(double kelvin) const;

  private:
    /// By wavelength: what light there adds to the colour, and to the luminance.
    std::vector<Triple> colour_;
    std::vector<double> luminance_;
};

}  // namespace covtrace
