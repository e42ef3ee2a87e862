/// Rasterizer of triangles into voxels, one batch at a time: the part of building a VoxelGrid that
/// runs in parallel.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "geometry/affine.h"
#include "occluders/voxel_grid.h"

namespace covtrace {

/// Integrals over the area of the triangles that lies in one voxel, the triangles' weights
/// included.
struct VoxelSums {
    float area = 0;
    Vec3 position;         ///< position relative to the voxel's middle, times area
    Vec3 velocity;         ///< velocity times area
    NormalTensor normals;  ///< n n^T times area
    void add(const VoxelSums& other);
};

struct VoxelEntry {
    /// Brick * 512 + z * 64 + y * 8 + x: the brick's index in the top level, and the voxel's place
    /// among the brick's 8 x 8 x 8.
    uint64_t key = 0;
    VoxelSums sums;
};

/// Size and place of the voxels.
struct VoxelLayout {
    float size = 1;                      ///< edge of a voxel, scene units
    Vec3 origin;                         ///< least corner of the first voxel
    Bounds3 box;                         ///< box beyond which triangles are left out
    std::array<int, 3> bricks{0, 0, 0};  ///< bricks of 8 x 8 x 8 voxels along each axis
};

class VoxelRasterizer {
  public:
    /// Begins without triangles; `layout` must outlive this object.
    explicit VoxelRasterizer(const VoxelLayout& layout) : layout_(layout) {}
    /// Adds a triangle. `velocity` is a field over world points, null where nothing moves; `weight`
    /// multiplies the area.
    void add(const std::array<Vec3, 3>& corners, const Affine* velocity, float weight);
    /// Gives one entry per voxel that was met, each key once, in no order, and forgets them.
    std::vector<VoxelEntry> take();

  private:
    /// Halves a piece of a triangle until it is small, and enters it; `area` is the piece's, weight
    /// included.
    void split(Vec3 a, Vec3 b, Vec3 c, float area);
    /// Adds a small piece to the voxel that its middle lies in.
    void enter(Vec3 center, float area);

    const VoxelLayout& layout_;
    Vec3 normal_;
    const Affine* velocity_ = nullptr;
    std::vector<VoxelEntry> entries_;
    std::unordered_map<uint64_t, uint32_t> index_;
    uint64_t last_key_ = ~uint64_t{0};
    uint32_t last_ = 0;
};

}  // namespace covtrace
