/// Every occupied voxel that a segment crosses, in order: the use of the grid in Belcour 2012, "A
/// Frequency Analysis of Light Transport: From Theory to Implementation", section 5.1.
#pragma once

#include <array>

#include "occluders/voxel_grid.h"

namespace covtrace {

/// Walks a segment from voxel to voxel (Amanatides and Woo 1987, "A Fast Voxel Traversal Algorithm
/// for Ray Tracing"). The occupied voxels at either end, up to the first empty one, are left out:
/// they belong to the surfaces that the segment starts and ends on. No heap use.
///
///     VoxelWalk walk(grid, from, to);
///     for (VoxelWalk::Crossing c; walk.next(c);) …
class VoxelWalk {
  public:
    struct Crossing {
        float s = 0;       ///< distance from the start to the middle of the way through the voxel
        float length = 0;  ///< of the way through the voxel
        const Voxel* voxel = nullptr;  ///< the grid's
    };
    VoxelWalk(const VoxelGrid& grid, Vec3 from, Vec3 to);
    bool next(Crossing& crossing);

  private:
    /// The voxel of the grid in the current cell, or null where the cell is empty.
    const Voxel* voxel() const;
    /// Enters the next cell of the way.
    void step();

    const VoxelGrid& grid_;
    std::array<int, 3> cell_{}, side_{};  ///< `side_`: 1, -1 or 0 along each axis
    Vec3 leave_, width_;      ///< distance to the next plane of each axis, and between its planes
    float at_ = 0, end_ = 0;  ///< distances: where the current cell begins, where the walk ends
};

}  // namespace covtrace
