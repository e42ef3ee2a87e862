/// Images of scenes whose light does not reach what the camera sees.
#pragma once

#include "image/image.h"

namespace covtrace {

/// The share of the surfaces in view that are darker than the first step of eight bits above black
/// would be on them, by the image's first layer and its layer "albedo". 0 where there is no such
/// layer or nothing in view, and surfaces that are black themselves don't count.
double dark_share(const Image& image);

/// From this share on an image is told to be dark.
inline constexpr double kMostlyDark = 0.5;

}  // namespace covtrace
