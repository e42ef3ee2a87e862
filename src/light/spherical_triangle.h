/// Directions to a triangle, uniform by solid angle: Arvo's scheme (1995, "Stratified sampling of
/// spherical triangles") in the formulation of Peters 2021, "BRDF importance sampling for polygonal
/// lights", section 4, which needs no angles of the spherical triangle and stays exact for small
/// ones.
#pragma once

#include "geometry/geometry.h"

namespace covtrace {

struct SphericalTriangle {
    Vec3 v0, v1, v2;        ///< unit, from the point to the corners
    float volume = 0;       ///< |v0 . (v1 x v2)|
    float g1 = 0, g2 = 0;   ///< v0.v2 + v1.v2 and 1 + v0.v1
    float solid_angle = 0;  ///< steradians; 0 where the point lies on a corner
};

SphericalTriangle spherical_triangle(const WorldTriangle& triangle, Vec3 p);
/// A unit direction into the triangle with density 1 / solid_angle, which must be above zero.
Vec3 sample_direction(const SphericalTriangle& t, Vec2 u);

}  // namespace covtrace
