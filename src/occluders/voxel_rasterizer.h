/// Enters triangles into voxels, one batch at a time: the part of building a VoxelGrid that runs in
/// parallel.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "geometry/affine.h"
#include "occluders/voxel_grid.h"

namespace covtrace {

/// Sums over the area that lies in one voxel.
struct VoxelSums {
    float area = 0;
    Vec3 position;  ///< relative to the voxel's middle
    Vec3 velocity;
    NormalTensor normals;
    void add(const VoxelSums& other);
};

struct VoxelEntry {
    uint64_t key = 0;  ///< place of the brick in the top level * 512 + z * 64 + y * 8 + x
    VoxelSums sums;
};

/// Size and place of the voxels.
struct VoxelLayout {
    float size = 1;
    Vec3 origin;
    Bounds3 box;
    std::array<int, 3> bricks{0, 0, 0};
};

class VoxelRasterizer {
  public:
    explicit VoxelRasterizer(const VoxelLayout& layout) : layout_(layout) {}
    /// Adds a triangle. `velocity` is a field over world points, null where nothing moves; `weight`
    /// multiplies the area.
    void add(const std::array<Vec3, 3>& corners, const Affine* velocity, float weight);
    /// Gives one entry per voxel that was met, each key once, in no order, and forgets them.
    std::vector<VoxelEntry> take();

  private:
    /// Halves a piece of a triangle until it is small; `area`: of the piece, weight included.
    void split(Vec3 a, Vec3 b, Vec3 c, float area);
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
