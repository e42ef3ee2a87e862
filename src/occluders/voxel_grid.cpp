#include "occluders/voxel_grid.h"

#include <algorithm>
#include <cmath>

namespace covtrace {

size_t VoxelGrid::memory() const {
    return top_.capacity() * sizeof(top_[0]) + stored_.capacity() * sizeof(Brick) +
           voxels_.capacity() * sizeof(Voxel) + offsets_.capacity() * sizeof(Offset);
}

float VoxelGrid::longest_side() const {
    const Vec3 sides = box_.hi - box_.lo;
    return std::max({sides.x, sides.y, sides.z});
}

VoxelGrid::Cell VoxelGrid::cell_of(Vec3 point) const {
    const Vec3 p = (point - origin_) / size_;
    return {static_cast<int>(std::floor(p.x)), static_cast<int>(std::floor(p.y)),
            static_cast<int>(std::floor(p.z))};
}

const VoxelGrid::Brick* VoxelGrid::brick_of(Cell c) const {
    const int x = c.x >> 3, y = c.y >> 3, z = c.z >> 3;
    if (x < 0 || y < 0 || z < 0 || x >= bricks_[0] || y >= bricks_[1] || z >= bricks_[2])
        return nullptr;
    const int32_t index =
        top_[(static_cast<size_t>(z) * static_cast<size_t>(bricks_[1]) + static_cast<size_t>(y)) *
                 static_cast<size_t>(bricks_[0]) +
             static_cast<size_t>(x)];
    return index < 0 ? nullptr : &stored_[static_cast<size_t>(index)];
}

const Voxel* VoxelGrid::find(Vec3 point) const {
    const Cell c = cell_of(point);
    const Brick* brick = brick_of(c);
    const int z = c.z & 7, bit = (c.y & 7) * 8 + (c.x & 7);
    if (!brick || !(brick->occupied[static_cast<size_t>(z)] >> bit & 1)) return nullptr;
    return &voxels_[voxel_index(*brick, z, bit)];
}

}  // namespace covtrace
