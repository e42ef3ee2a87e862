/// Loop's subdivision surfaces (Loop 1987, "Smooth Subdivision Surfaces Based on Triangles").
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "scene/scene_description.h"

namespace covtrace {

/// Refines the control mesh `levels` times, then moves the vertices to the limit surface and gives
/// them its normals. Borders follow a cubic B-spline of their own; where more than two triangles
/// share an edge, the edge is taken as a border, and vertices with anything but two border edges
/// stay where they are.
///
/// Weights are pbrt's: 3/16 for valence 3, 3/(8n) otherwise; tangents at borders are from Hoppe et
/// al. 1994, "Piecewise Smooth Surface Reconstruction". Indices must be in range.
TriangleMesh loop_subdivide(const std::vector<Vec3>& positions,
                            const std::vector<std::array<uint32_t, 3>>& triangles, int levels,
                            const SourceLocation& where);

}  // namespace covtrace
