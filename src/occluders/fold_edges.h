/// The edges of triangles that can be seen as outlines: borders and folds. Flat neighbours, of
/// which most meshes have many, leave no edge between them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
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

/// Collects triangles of one space and finds their edges. Corners at the very same place are one.
class FoldEdgeFinder {
  public:
    /// `most`: about how many triangles will be added.
    explicit FoldEdgeFinder(size_t most = 0);

    /// Which edges of a triangle are wanted, each from the corner of its index to the next one. All
    /// triangles at an edge have to want it or not.
    using Wanted = std::array<bool, 3>;
    /// Adds a triangle; dropped where a corner is not finite or two of them are at one place.
    void add(const std::array<Vec3, 3>& corners, const Wanted& wanted = {true, true, true});
    /// The edges, in an order that depends on nothing but what was added. Not thread-safe.
    std::vector<FoldEdge> edges() const;

  private:
    /// One triangle at an edge.
    struct Side {
        uint32_t a = 0, b = 0;  ///< the edge's corners, the smaller number first
        uint32_t opposite = 0;  ///< the triangle's third corner
    };

    uint32_t weld(Vec3 position);
    void grow(size_t slots);
    /// Makes an edge from all sides at it. Returns false where it is no outline from anywhere.
    bool find(std::span<const Side> sides, FoldEdge& edge) const;

    std::vector<Vec3> corners_;
    std::vector<uint32_t> table_;  ///< open addressing by the position's bits
    std::vector<Side> sides_;
    mutable std::vector<Vec3> directions_;  ///< of `find`
};

}  // namespace covtrace
