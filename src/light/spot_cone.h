/// The cone that the light of a spotlight stays within.
#pragma once

#include "core/vec.h"

namespace covtrace {

/// Light falls off from its whole intensity in the inner cone to nothing outside of the outer one.
struct SpotCone {
    float cos_inner = -1, cos_outer = -1;  ///< of the cones' half angles

    /// From degrees, as SpotLight has them.
    static SpotCone from_degrees(float angle, float delta_angle);
    /// The factor in [0, 1] on the light in a direction with this cosine to the axis, as in
    /// pbrt-v4: a smoothstep of the cosine between both cones.
    float falloff(float cosine) const;
    /// The integral of the factor over all directions, steradians.
    float solid_angle() const;
    /// Angular variance of the light along one axis across the cone's own, radians^2.
    float variance() const;
};

}  // namespace covtrace
