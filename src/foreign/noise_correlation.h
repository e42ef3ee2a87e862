/// Correlation of the noise of neighbouring pixels.
#pragma once

#include "reconstruction/half_buffer.h"

namespace covtrace {

/// The correlation of the noise of pixels that are neighbours in x or in y, as the difference of
/// both halves shows it: 0 where each sample counts in one pixel, 0.4 with Mitsuba's Gaussian pixel
/// filter. Differences are of luminances, relative to those around, and cut off at three times
/// their mean, so that no bright path decides. 0 for halves that do not differ.
float neighbours_correlation(const Halves& halves);

}  // namespace covtrace
