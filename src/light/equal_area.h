/// Clarberg's equal-area map between the unit square and the sphere of directions (2008, "Fast
/// equal-area mapping of the (hemi)sphere using SIMD"), oriented as in pbrt-v4: +z in the middle,
/// -z in the four corners, x to the right, y downwards in an image.
#pragma once

#include "core/vec.h"

namespace covtrace {

/// Unit direction of a point of [0, 1]^2.
Vec3 equal_area_square_to_sphere(Vec2 uv);
/// The point of [0, 1]^2 of a unit direction: the inverse of `equal_area_square_to_sphere`.
Vec2 equal_area_sphere_to_square(Vec3 w);

}  // namespace covtrace
