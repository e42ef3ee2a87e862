/// The box that most of a scene lies in, without far outliers. Only for .cpp files of this folder.
#pragma once

#include "geometry/placed_scene.h"

namespace covtrace {

/// A box that holds the middle 98 % of the corners of all shapes along every axis, at the shutter's
/// opening, and most curved shapes with them; by a sample of at most a few times 2^16 corners.
/// Empty where the scene is.
Bounds3 core_bounds(const Geometry::Impl& geometry);

}  // namespace covtrace
