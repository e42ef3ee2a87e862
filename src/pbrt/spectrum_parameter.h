/// Makes colours of parameters of the types rgb, spectrum and blackbody.
#pragma once

#include <memory>
#include <optional>
#include <string_view>

#include "colour/spectrum.h"
#include "core/vec.h"
#include "pbrt/build_context.h"
#include "scene/dispersion.h"

namespace covtrace {

/// The spectrum of a `spectrum` (inline pairs, a known name or a .spd file) or `blackbody`
/// parameter. Empty for a standard illuminant, of which only the colour is known. Errors:
/// Error(scene) for odd counts, wavelengths that don't increase, unknown names, broken files.
std::optional<Spectrum> spectrum_value(const Parameter& p, BuildContext& context);

/// The colour of a reflectance or a coefficient; `p` is of type rgb, spectrum or blackbody.
Rgb factor_colour(const Parameter& p, BuildContext& context);

/// The colour of light of luminance 1 from a black body at a temperature (kelvin, > 0), for the
/// film's sensor.
Rgb blackbody_colour(double kelvin, const BuildContext& context);
/// The colour of a light: rgb as it is, anything else at luminance 1 (pbrt's photometric
/// normalisation); white where the parameter is missing.
Rgb light_colour(ParameterList& parameters, std::string_view name, BuildContext& context);
/// The product of `light` and `factor`. Errors: Error(scene) at `where` in case single precision
/// can't hold it, or its product with the film's scale.
Rgb scaled_light(Rgb light, float factor, const SourceLocation& where, const BuildContext& context);

/// An index of refraction.
struct RefractiveIndex {
    float eta = 1;                                 ///< of a spectrum that at 587.6 nm
    std::shared_ptr<const Dispersion> dispersion;  ///< of one that varies
};
/// An index of refraction: a number, or a spectrum. Errors: Error(scene) where it isn't positive.
RefractiveIndex refractive_index(ParameterList& parameters, std::string_view name, float otherwise,
                                 BuildContext& context);
/// The index of what is rendered without dispersion: coats and panes. Warns of one that varies.
float constant_index(ParameterList& parameters, std::string_view name, float otherwise,
                     BuildContext& context);

}  // namespace covtrace
