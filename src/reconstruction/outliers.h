/// Rare bright paths: taken out before the candidates see them, given back afterwards.
#pragma once

#include "reconstruction/half_buffer.h"

namespace covtrace {

/// Limits every pixel of each half to a multiple of the brightest pixel of the *other* half within
/// 3 x 3 pixels, and returns what was cut off, as the mean of both halves: limited mean + excess =
/// mean. What both halves see is never cut, so nothing is in the limit of many samples. Colours
/// keep their hue.
ColorPlanes split_outliers(Halves& halves);

/// Adds the excess to `color`, spread over the neighbourhood in proportion to the light that is
/// there: e(p) goes to q as G(q - p) Y(q) / (G * Y)(p), Y the luminance of `color`, G a wide
/// Gaussian. The sum over the image stays but for what falls on its border.
void add_excess(const ColorPlanes& excess, ColorPlanes& color);

/// Luminance of every pixel.
Plane luminance(const ColorPlanes& color);

}  // namespace covtrace
