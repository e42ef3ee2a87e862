/// How much a colour counts when a light or a direction of an environment is chosen.
#pragma once

#include "core/vec.h"

namespace covtrace {

/// The weight of a colour is the mean of its channels: luminance would starve saturated blue lights
/// of samples.
constexpr float choice_weight(Rgb c) {
    return (c.r + c.g + c.b) * (1.0f / 3);
}

/// How much a light counts for a surface that sees it under the cosine `cos_theta` to its normal.
/// Never zero: a rough normal or a transmitting surface may be lit from behind, and a probability
/// of nearly zero for it would make fireflies.
constexpr float side_weight(float cos_theta) {
    return std::max(0.02f, cos_theta >= 0 ? cos_theta : -0.1f * cos_theta);
}

}  // namespace covtrace
