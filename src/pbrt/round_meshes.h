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
    /// The directions that a ribbon faces, at both ends of each segment. Empty for others.
    std::vector<Vec3> normals = {};

    /// How many segments the control points make.
    size_t segments() const {
        const auto n = static_cast<size_t>(degree);
        return is_bspline ? points.size() - n : (points.size() - 1) / n;
    }
};
/// An open tube along the curve, of so many sides; u runs along it, v around it. Slender ones have
/// flat sides, turned by a hash of the curve, all others smooth normals.
int sides_of(const CurveDescription& curve);
TriangleMesh curve_mesh(const CurveDescription& curve);
/// A strip along the curve that faces its normals, as far as they stand upright on it: from one end
/// of a segment to the other they turn evenly. u runs along it, v across, as seen from the normals'
/// side as in pbrt.
TriangleMesh ribbon_mesh(const CurveDescription& curve);

}  // namespace covtrace
