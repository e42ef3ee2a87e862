/// Meshes in place of shapes that covtrace doesn't intersect directly.
#pragma once

#include <vector>

#include "scene/scene_description.h"

namespace covtrace {

/// An open cylinder about z, facing outwards, with smooth normals and pbrt's (u, v).
TriangleMesh cylinder_mesh(float radius, float z_min, float z_max, float phi_max_degrees,
                           int segments);

/// pbrt's curve: Bézier segments that share their ends, or a uniform B-spline, of degree 2 or 3.
struct CurveDescription {
    std::vector<Vec3> points;
    int degree = 3;
    bool is_bspline = false;
    float width0 = 1, width1 = 1;  ///< diameters at both ends
};
/// An open tube along the curve, of so many sides; u runs along it, v around it. Slender ones have
/// flat sides, turned by a hash of the curve, all others smooth normals.
int sides_of(const CurveDescription& curve);
TriangleMesh curve_mesh(const CurveDescription& curve);

}  // namespace covtrace
