/// The aperture of a thin lens: a disc, or a polygon that its blades leave open.
#pragma once

#include "core/vec.h"
#include "scene/scene_description.h"

namespace covtrace {

/// A point of the aperture from one of the unit square, all parts of it alike; in units of the
/// radius of the circle around it, x to the right and y up.
Vec2 aperture_point(const ApertureBlades& blades, Vec2 u);

/// Radius, in the same unit, of the disc whose points have the same variance: the mean over both
/// axes for an aperture that is narrower than high.
float radius_of_like_disc(const ApertureBlades& blades);

}  // namespace covtrace
