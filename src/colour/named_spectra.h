/// The spectra that pbrt-v4 knows by name: metals, glasses, standard illuminants.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "colour/spectrum.h"
#include "core/vec.h"

namespace covtrace {

/// The spectrum of a material: "metal-Ag-eta", "metal-Ag-k", …, and "glass-BK7", ….
std::optional<Spectrum> material_spectrum(std::string_view name);
/// The colour, at luminance 1, of "stdillum-A", "stdillum-D50", "stdillum-D65", "stdillum-F1" to
/// "stdillum-F12" or "illum-acesD60".
std::optional<Rgb> illuminant_colour(std::string_view name);
/// Names of all spectra, for messages.
const std::vector<std::string>& spectrum_names();

}  // namespace covtrace
