/// The blur of an edge: penumbrae, and borders out of focus or in motion. An edge has no second
/// moment, but its blur has: that of the derivative across it (the line spread function).
#pragma once

#include "laboratory/fields.h"

namespace covtrace {

struct EdgeSpread {
    double centre = 0;  ///< place of the edge, pixels from the central ray along the direction
    double deviation =
        0;  ///< of the line spread function, pixels; its bandwidth is 1/(2 pi deviation)
    double low = 0, high = 0;  ///< means of the field at the two ends
};

/// Samples the field across an edge, from -reach to reach pixels along the unit `direction`,
/// integrated over lens and shutter, and divides it by `without`, the field without the edge (none:
/// by 1), since light that varies by itself is no blur. Both ends must then lie on plateaus: they
/// are the mean of the outer tenths. `samples` estimates are taken in all; the result is the same
/// for any number of threads.
EdgeSpread edge_spread(const LocalField& field, const LocalField& without, Vec2 direction,
                       double reach, uint32_t samples, uint64_t seed);

}  // namespace covtrace
