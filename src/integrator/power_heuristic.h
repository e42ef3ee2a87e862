/// How two strategies share what both of them find.
#pragma once

#include <algorithm>
#include <cmath>

namespace covtrace {

/// Weight of a sample of density a whose direction another strategy samples with density b: the
/// power heuristic with exponent 2 (Veach 1997, "Robust Monte Carlo methods for light transport
/// simulation", section 9.2.3). An infinite density outweighs any other.
inline float power_heuristic(float a, float b) {
    if (std::isinf(a)) return 1;
    if (std::isinf(b)) return 0;
    // Squares of large densities, as of a lamp far away, would be no floats any more.
    constexpr float kLargest = 1e18f;
    if (const float largest = std::max(a, b); largest > kLargest) {
        a /= largest;
        b /= largest;
    }
    const float a2 = a * a, b2 = b * b;
    return a2 + b2 > 0 ? a2 / (a2 + b2) : 0;
}

}  // namespace covtrace
