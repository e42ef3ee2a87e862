/// One scattering event inside a medium: from the light that arrives at a point to the light that
/// leaves it.
#pragma once

#include "covariance/covariance.hpp"
#include "frequency/light_source.h"

namespace covtrace {

/// Sends `arriving` on in the direction `outgoing` (unit, towards the camera) by Henyey and
/// Greenstein's phase function of mean cosine `g`. The result is in the frame
/// covariance::frame_along(outgoing).
///
/// The phase function is a lobe about the unchanged direction. Its covariance is its curvature at
/// the peak over 4 pi^2, 3 |g| / (1 - g)^2 / (4 pi^2): near the peak
/// p ~ (1 + g a^2 / (1 - g)^2)^(-3/2) at an angle of a. Positions are those in the plane through
/// the point across the new direction; what varies along the old one is not known to a local light
/// field and counts as constant.
LightField scatter_in_medium(const LightField& arriving, float g,
                             covariance::Vec3<double> outgoing);

}  // namespace covtrace
