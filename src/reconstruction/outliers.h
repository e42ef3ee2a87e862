/// Outliers: rare bright paths, taken out before the candidates see them. LightReturn gives their
/// light back.
#pragma once

#include "reconstruction/half_buffer.h"

namespace covtrace {

/// Limits every pixel of each half to a multiple of the brightest pixel of the *other* half within
/// 3 x 3 pixels. Light that both halves see is never cut, so that nothing is in the limit of many
/// samples. Colours keep their hue.
void limit_outliers(Halves& halves);

}  // namespace covtrace
