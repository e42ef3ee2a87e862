/// One bilinear patch p(u, v) = lerp(v, lerp(u, p00, p10), lerp(u, p01, p11)).
#pragma once

#include "geometry/affine.h"

namespace covtrace {

struct BilinearPatch {
    Vec3d p00, p10, p01, p11;

    Vec3d point(double u, double v) const {
        return (p00 * (1 - u) + p10 * u) * (1 - v) + (p01 * (1 - u) + p11 * u) * v;
    }
    Vec3d du(double v) const { return (p10 - p00) * (1 - v) + (p11 - p01) * v; }
    Vec3d dv(double u) const { return (p01 - p00) * (1 - u) + (p11 - p10) * u; }
    /// The mixed second derivative d^2 p / du dv; zero for parallelograms.
    Vec3d twist() const { return p00 - p10 - p01 + p11; }
};

/// Whether a patch that was given in single precision has no more twist than its roundings leave:
/// where all of a mesh's have not, rays meet the two triangles of each.
bool is_parallelogram(const BilinearPatch& patch);

struct PatchHit {
    double t = 0, u = 0, v = 0;
};

/// Nearest hit of the ray with t in (t_min, t_max); false where there is none. The direction may
/// have any length. Two iso-lines u = const meet the ray at the roots of a quadratic (Reshetov
/// 2019, "Cool patches: a geometric approach to ray/bilinear patch intersections").
bool intersect_patch(const BilinearPatch& patch, Vec3d origin, Vec3d direction, double t_min,
                     double t_max, PatchHit& hit);

}  // namespace covtrace
