/// The variation of a light at its source, with which the frequency analysis begins.
#pragma once

#include "core/frame.h"
#include "core/vec.h"

namespace covtrace {

/// The spectrum of a light at its source, from which the covariance of its radiance starts. Each
/// field says for which kinds it is set.
struct SourceSpectrum {
    enum class Kind { area, point, directional, environment };
    Kind kind = Kind::area;
    /// Frame of the quantities below. area: at the emitting point, z = normal; all others: x, y
    /// span the directions, z is the direction that the light travels in.
    Frame tangent;
    /// area: second moments of the whole emitter about its centroid in (tangent.x, tangent.y),
    /// length^2
    float s11 = 0, s12 = 0, s22 = 0;
    float k11 = 0, k12 = 0, k22 = 0;  ///< area: shape operator
    Vec3 velocity, angular_velocity;  ///< area
    /// area: from the point to the nearest point of the emitter's border (edges that belong to one
    /// triangle only, the rim of a disk); infinite for closed meshes and for spheres, whose
    /// silhouette depends on the view. environment: radians to the nearest rim of a disc; infinite
    /// where there is none, or where rims were not asked for.
    float border_distance = kInfinity;
    /// Unit vector towards that border point, in (tangent.x, tangent.y).
    Vec2 border_direction{1, 0};
    /// environment, directional, and point for the image of a goniometric or projection light:
    /// angular covariance in (tangent.x, tangent.y), (cycles per radian)^2
    float a11 = 0, a12 = 0, a22 = 0;
    float cone_variance = 0;  ///< point, area: angular variance of a spot's cone, 0: none
};

}  // namespace covtrace
