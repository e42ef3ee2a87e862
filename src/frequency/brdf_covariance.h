/// The choice between two descriptions of a BRDF.
#pragma once

#include "core/enum_names.h"

namespace covtrace {

/// Description of a BRDF in the frequency analysis.
enum class BrdfCovariance {
    local,  ///< its lobes as they are at the pair of directions that the path took
    global  ///< each lobe's peak, as in Belcour 2012
};

template <>
inline constexpr auto kEnumNames<BrdfCovariance> = enum_names<BrdfCovariance>(
    {{BrdfCovariance::local, "local"}, {BrdfCovariance::global, "global"}});

}  // namespace covtrace
