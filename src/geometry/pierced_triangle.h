/// Triangles of flat shapes with holes, cut into pieces of which the opaque ones are left.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "core/vec.h"
#include "geometry/surface.h"

namespace covtrace {

/// A triangle of a flat shape, by the number that Tessellation gives it. A triangle that borders on
/// another one has pieces with the very same corners there, where both are cut alike into a power
/// of two: places on an edge are then exact from either side, before they become floats. (They are
/// not where a coordinate changes by more than a million times itself within a triangle.)
class PiercedTriangle {
  public:
    using IsOpaque = std::function<bool(const SurfacePoint& local)>;

    /// A piece of the triangle.
    struct Piece {
        std::array<Vec3, 3> corners;
        /// For each edge, from the corner of its index to the next one, the triangle's edge that it
        /// is a part of, or kInside.
        std::array<size_t, 3> edges;
    };
    static constexpr size_t kInside = 3;

    /// `shape`: is_flat().
    PiercedTriangle(const LocalShape& shape, uint32_t triangle)
        : shape_(shape), triangle_(triangle) {}

    /// The opaque ones of `per_edge` squared pieces, as their middles tell; `per_edge` >= 1.
    std::vector<Piece> pieces(int per_edge, const IsOpaque& is_opaque) const;

  private:
    /// The point at `i` of `n` steps along the first edge and `j` towards the third corner.
    SurfacePoint point(float i, float j, float n) const;

    const LocalShape& shape_;
    uint32_t triangle_;
};

}  // namespace covtrace
