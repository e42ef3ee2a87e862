/// Light that an image lacks and that stays in its pixels: elsewhere it would be seen as a glow.
#pragma once

#include "reconstruction/half_buffer.h"

namespace covtrace {

/// Adds to `color` the part of the lacking light e that stays in place: things that are too bright
/// for the light around them (`around`, sums over some hundred pixels). The brightest pixels of a
/// thing stay: what is around it has noise of its own.
void keep_in_place(const Plane& around, const ColorPlanes& e, ColorPlanes& color);

/// Adds to `color` so much of the lacking light e, from its brightest pixels, that its luminance
/// sums up to `luminance_kept`, or all that there is.
void keep_brightest(const ColorPlanes& e, float luminance_kept, ColorPlanes& color);

}  // namespace covtrace
