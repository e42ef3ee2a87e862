/// Reports at the end of a round: how far the render is from done, and how the image looks.
#pragma once

#include "render/film.h"
#include "render/progress.h"

namespace covtrace {

/// Least samples per pixel before an error is believed: fewer cannot tell that it is small, as
/// paths that carry much light and are rare have not been met yet.
inline constexpr double kLeastForError = 16;

/// Estimated sqrt(relMSE) of the film's raw pixels: sqrt of the mean over pixels and channels of
/// variance of the mean over (mean² + 0.01). Not a number where less than half of the pixels have
/// two samples.
double estimated_error(const Film& film);

/// Shows the image, without reconstruction, to whoever watches the render.
void show_round(const Monitor& monitor, const Film& film, const PixelBounds& display,
                bool has_holes);

}  // namespace covtrace
