/// The luminance of planes of colours, and from where on errors are relative to it.
#pragma once

#include "core/vec.h"
#include "reconstruction/half_buffer.h"

namespace covtrace {

/// The eps of relMSE: the errors of pixels darker than a tenth count as they are. It is meant for
/// images that are exposed for a display; others are brought there (core/display_exposure.h).
constexpr float kDarkSquared = 0.01f;

inline Plane luminance(const ColorPlanes& color) {
    Plane y(color[0].width, color[0].height);
    for (size_t i = 0; i < y.size(); ++i)
        y[i] = luminance(Rgb(color[0][i], color[1][i], color[2][i]));
    return y;
}

}  // namespace covtrace
