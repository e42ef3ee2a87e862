/// Measured scattering properties of real liquids and solids, by the names that pbrt-v4 gives them.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/vec.h"

namespace covtrace {

/// Coefficients of a medium per millimetre, linear RGB. The measurements are of reduced scattering,
/// which pbrt takes for sigma_s as it is.
struct NamedMedium {
    Rgb sigma_s, sigma_a;
};

/// The medium of a name, whose case counts, as in pbrt. Empty for unknown names.
std::optional<NamedMedium> named_medium(std::string_view name);
std::vector<std::string> medium_names();

}  // namespace covtrace
