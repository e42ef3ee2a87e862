/// Analytic spheres and disks: intersection and differential geometry in double, in object space,
/// so that transforms need not be uniform.
#pragma once

#include "geometry/surface.h"

namespace covtrace {

Quadric make_quadric(const Sphere& sphere, const Transform& local_from_object, bool reverse);
Quadric make_quadric(const Disk& disk, const Transform& local_from_object, bool reverse);

/// Nearest hit of the local ray with t in (t_min, t_max); false where there is none. The direction
/// may have any length.
bool intersect_quadric(const Quadric& quadric, Vec3d origin, Vec3d direction, double t_min,
                       double t_max, double& t);
/// Box in local space that holds the quadric, rounded outwards.
Bounds3 quadric_bounds(const Quadric& quadric);
/// Point on the surface in object space for pbrt's (u, v) in [0, 1]^2.
Vec3d quadric_object_point(const Quadric& quadric, double u, double v);
SurfacePoint quadric_point(const Quadric& quadric, Vec3d near);
SurfaceDerivatives quadric_derivatives(const Quadric& quadric, Vec3d near);

}  // namespace covtrace
