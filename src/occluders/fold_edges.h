/// The edges of triangles that can be seen as outlines: borders and folds. Flat neighbours, of
/// which most meshes have many, leave no edge between them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/vec.h"

namespace covtrace {

/// An edge from `a` to `b` and the wedge that the surfaces around it fill. Seen from p the edge is
/// an outline where all of these surfaces lie on one side of the plane through p, a and b.
struct FoldEdge {
    Vec3 a, b;
    /// Normals, unit and across the edge, of the wedge's two outer faces: the directions from the
    /// edge into the faces, turned by a right angle about the edge.
    Vec3 normal0, normal1;
};

/// Collects triangles of one space and finds their edges. Corners at the very same place are one,
/// whichever mesh they belong to.
class FoldEdgeFinder {
  public:
    /// Adds triangles; those with a corner that is not finite are dropped.
    void add(const std::vector<Vec3>& positions,
             const std::vector<std::array<uint32_t, 3>>& triangles);
    /// Gives the edges, in an order that depends on nothing but what was added, and forgets
    /// everything.
    std::vector<FoldEdge> take();

  private:
    uint32_t weld(Vec3 position);
    void grow();

    std::vector<Vec3> corners_;
    std::vector<uint32_t> table_;  ///< open addressing by the position's bits
    std::vector<std::array<uint32_t, 3>> triangles_;
};

}  // namespace covtrace
