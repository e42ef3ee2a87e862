/// The choice between two descriptions of a BRDF.
#pragma once

namespace covtrace {

/// What stands for a BRDF in the frequency analysis.
enum class BrdfCovariance {
    local,  ///< its lobes as they are at the pair of directions that the path took
    global  ///< each lobe's peak, as in the thesis
};

}  // namespace covtrace
