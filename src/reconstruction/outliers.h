/// Rare bright paths: taken out before the candidates see them, given back afterwards.
#pragma once

#include "reconstruction/half_buffer.h"

namespace covtrace {

/// How many times as far as other light that of one path goes.
constexpr float kWidening = 4;

/// Of what is given back of every pixel, the shares that stay around it and in it; the rest goes
/// far.
struct ReturnedShares {
    Plane near, own;
};

/// Limits every pixel of each half to a multiple of the brightest pixel of the *other* half within
/// 3 x 3 pixels. What both halves see is never cut, so nothing is in the limit of many samples.
/// Colours keep their hue.
void limit_outliers(Halves& halves);

/// Gives the neighbourhoods of `color` the energy of `raw` back: what was cut off, and what filters
/// took from small bright things. The difference e = raw - color of p goes to q as
/// G(q - p) Y(q) / (G * Y)(p), in proportion to the light Y that is there, G a wide Gaussian: the
/// sum over the image is that of `raw`, but for pixels that would become negative. What one pixel
/// has of e beyond a tenth of all others around it goes further away: one path's light, were it
/// rare enough, would be a blotch; of what has m times that, 1/m^2 stays near. Where so much of
/// that meets that it would glow, the rest stays in its own pixel.
ReturnedShares return_energy(const ColorPlanes& raw, ColorPlanes& color);

/// Luminance of every pixel.
Plane luminance(const ColorPlanes& color);

}  // namespace covtrace
