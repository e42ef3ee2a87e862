/// Images of scenes whose light does not reach what the camera sees.
#pragma once

#include "image/image.h"

namespace covtrace {

/// The share of the surfaces in view in whose block of 16 x 16 pixels no sample found light, by the
/// layer "raw" or without it the first layer, and that the first layer has darker than the first
/// step of eight bits above black would be on them. 0 where there is no layer "albedo" or nothing
/// in view, and surfaces that are black themselves don't count.
double dark_share(const Image& image);

/// Whether an image shows nothing at all: it is black, and its layer "N" has no surface in view.
/// False without that layer, and of a part of the view, whose rest nobody has seen.
bool shows_nothing(const Image& image);

/// From this share on an image is told to be dark.
inline constexpr double kMostlyDark = 0.5;

}  // namespace covtrace
