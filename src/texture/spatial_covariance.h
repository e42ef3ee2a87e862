/// How fast an image varies around a point.
#pragma once

namespace covtrace {

/// Covariance of an image's amplitude spectrum: symmetric 2x2, in (cycles per unit of s or t)^2.
struct SpatialCovariance2 {
    float ss = 0, st = 0, tt = 0;
};

}  // namespace covtrace
