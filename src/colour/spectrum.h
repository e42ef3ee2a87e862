/// Spectra of scene files and the linear Rec.709 colours that stand for them
/// (docs/reference/colour.md).
///
/// Integrals use the colour matching functions of the CIE 1931 standard observer, from 380 to 780
/// nm. Every colour is divided by that of D65 through the same functions, so that a white surface
/// is exactly (1, 1, 1). Spectra are integrated exactly as straight lines between their
/// wavelengths, however near these lie.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/vec.h"

namespace covtrace {

/// A spectrum: values at increasing wavelengths (nanometres), linear between them.
struct Spectrum {
    std::vector<float> wavelengths, values;
    bool extends = false;  ///< the end values go on outside; otherwise zero there
    double at(double wavelength) const;
};

/// Integral of CIE's y over wavelengths in nanometres, as pbrt has it: luminance of light of 1 at
/// all of them.
inline constexpr double kLuminanceOfOne = 106.856895;

/// Distance of the observer's samples, nanometres.
inline constexpr int kObserverStep = 5;
/// A sample of the observer for smooth functions, one every kObserverStep: a wavelength
/// (nanometres) and what light there adds to a colour.
struct ObserverSample {
    double wavelength = 0;
    std::array<double, 3> weight{};  ///< red, green, blue
};
/// All samples of the observer. The colour under D65 of a factor f is the sum of f(wavelength) *
/// weight, exact where f is straight between the wavelengths; that of f = 1 is white.
std::span<const ObserverSample> observer_samples();

/// Spectrum of a black body at this temperature (kelvin, > 0) by Planck's law from 360 to 830 nm,
/// its largest value there 1.
Spectrum blackbody_spectrum(double kelvin);

/// Luminance of a black body at this temperature (kelvin, > 0) whose spectral radiance is 1 where
/// it is largest, at any wavelength. Light of 1 at all wavelengths has the luminance 106.856895,
/// the integral of CIE's y over wavelengths in nanometres: pbrt divides by it in lights and in
/// "Le", and not where media glow by their temperature.
float blackbody_luminance(double kelvin);

/// Colour of a surface with this reflectance (or of any other factor) under D65.
Rgb reflectance_colour(const Spectrum& s);
/// Colour of light with this spectrum, scaled to luminance 1, as pbrt normalises its lights; then
/// negative components, of colours outside Rec.709, are set to 0, which brightens them. A spectrum
/// of one wavelength is a line. Empty and invisible light gives black.
Rgb emission_colour(const Spectrum& s);
/// The colour of luminance 1 with these CIE 1931 chromaticities.
Rgb chromaticity_colour(double x, double y);

/// Index of refraction and absorption of a conductor per colour channel.
struct ConductorColours {
    Rgb eta{1}, k{0};
};
/// Colours of a conductor for rendering in RGB. eta is `index`; k is chosen so that the reflectance
/// at normal incidence is the colour of the spectral one. Where no k >= 0 does that, k is 0 and eta
/// is chosen instead.
ConductorColours conductor_colours(const Spectrum& eta, const Spectrum& k, Rgb index);
/// Mean of a spectrum over the wavelengths that each channel sees (its positive part times D65).
Rgb channel_means(const Spectrum& s);

}  // namespace covtrace
