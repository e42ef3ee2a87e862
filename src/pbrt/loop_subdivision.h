/// Loop's subdivision surfaces ("Smooth Subdivision Surfaces Based on Triangles", 1987).
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
/// Weights as in pbrt: 3/16 for valence 3, 3/(8n) otherwise; tangents at borders from Hoppe et al.
/// 1994. Pre: indices in range.
TriangleMesh loop_subdivide(const std::vector<Vec3>& positions,
                            const std::vector<std::array<uint32_t, 3>>& triangles, int levels,
                            const SourceLocation& where);

}  // namespace covtrace
