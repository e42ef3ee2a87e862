/// The cone that the light of a spotlight stays within.
#pragma once

#include "core/vec.h"

namespace covtrace {

/// Light falls off from its whole intensity in the inner cone to nothing outside of the outer one.
struct SpotCone {
    float cos_inner = -1, cos_outer = -1;  ///< of the cones' half angles
    /// Whether the light shines through a deep grid, as softboxes have one: at the angle t to the
    /// axis its slats leave the share 1 - tan(t) / tan(outer angle). The inner cone is the axis.
    bool is_grid = false;

    /// From degrees, as SpotLight has them.
    static SpotCone from_degrees(float angle, float delta_angle);
    /// A grid's, from degrees; at 90 it lets everything pass.
    static SpotCone grid(float angle);
    /// The factor in [0, 1] on the light in a direction with this cosine to the axis: as in pbrt-v4
    /// a smoothstep of the cosine between both cones, or a grid's.
    float falloff(float cosine) const;
    /// The integral of the factor over all directions, steradians.
    float solid_angle() const;
    /// Angular variance of the light along one axis across the cone's own, radians^2.
    float variance() const;
};

}  // namespace covtrace
