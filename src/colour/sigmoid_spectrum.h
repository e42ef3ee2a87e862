/// Smooth spectra that stand for colours: a sigmoid of a polynomial of degree two in the wavelength
/// (Jakob and Hanika, "A low-dimensional function space for efficient spectral upsampling",
/// Computer Graphics Forum 38(2), 2019), the family that pbrt-v4 renders colours with.
///
///     S(l) = 1/2 + p / (2 sqrt(1 + p^2)),     p = c0 + c1 t + c2 t^2,     t from -1 to 1 over l
#pragma once

#include <array>

#include "colour/spectrum.h"

namespace covtrace {

/// A spectrum between 0 and 1 at every wavelength; 1/2 everywhere unless coefficients are given.
struct SigmoidSpectrum {
    std::array<double, 3> coefficients{};
    double at(double wavelength) const;
};

/// The spectrum whose colour under D65 is `colour`, brought into [0.0001, 0.9999]; a constant one
/// for greys. Every such colour has one, the primaries too: the error is below 1e-4.
SigmoidSpectrum sigmoid_spectrum(Rgb colour);

/// The spectrum of a factor without upper limit, such as an index of refraction, as pbrt-v4 makes
/// it of `colour`: 2 m S, where m is the largest component and S the sigmoid of colour / (2 m).
Spectrum unbounded_spectrum(Rgb colour);

}  // namespace covtrace
