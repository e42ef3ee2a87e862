#include "occluders/voxel_walk.h"

#include <algorithm>
#include <cmath>

namespace covtrace {

VoxelWalk::VoxelWalk(const VoxelGrid& grid, Vec3 from, Vec3 to) : grid_(grid) {
    const float total = distance(from, to), size = grid.size_;
    if (grid.voxels_.empty() || !(total > 0) || !std::isfinite(total)) return;
    const Vec3 direction = (to - from) / total;
    float enter = 0, leave = total;
    for (int k = 0; k < 3; ++k) {
        // A surface in a far face of the box is in the voxel beyond it, or by rounding in one next
        // to that: the walk covers two voxels beyond the box.
        const float lo = grid.box_.lo[k] - 2 * size - from[k],
                    hi = grid.box_.hi[k] + 2 * size - from[k];
        if (direction[k] == 0) {
            if (lo > 0 || hi < 0) return;
            continue;
        }
        const float a = lo / direction[k], b = hi / direction[k];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
    }
    if (!(leave > enter)) return;
    const VoxelGrid::Cell first = grid.cell_of(from + direction * enter);
    cell_ = {first.x, first.y, first.z};
    at_ = enter;
    end_ = leave;
    for (int k = 0; k < 3; ++k) {
        const auto axis = static_cast<size_t>(k);
        side_[axis] = direction[k] > 0 ? 1 : direction[k] < 0 ? -1 : 0;
        const int plane = cell_[axis] + (side_[axis] > 0 ? 1 : 0);
        width_[k] = side_[axis] ? size / std::abs(direction[k]) : kInfinity;
        leave_[k] = side_[axis] ? (grid.origin_[k] + static_cast<float>(plane) * size - from[k]) /
                                      direction[k]
                                : kInfinity;
    }
    // Leave out the occupied voxels at either end: the surfaces there are the segment's own.
    while (at_ < end_ && voxel()) step();
    float last_empty = at_;
    for (VoxelWalk ahead = *this; ahead.at_ < end_;) {
        const bool is_empty = !ahead.voxel();
        ahead.step();
        if (is_empty) last_empty = ahead.at_;
    }
    end_ = std::min(end_, last_empty);
}

const Voxel* VoxelWalk::voxel() const {
    const VoxelGrid::Cell cell{cell_[0], cell_[1], cell_[2]};
    const VoxelGrid::Brick* brick = grid_.brick_of(cell);
    const int z = cell.z & 7, bit = (cell.y & 7) * 8 + (cell.x & 7);
    if (!brick || !(brick->occupied[static_cast<size_t>(z)] >> bit & 1)) return nullptr;
    return &grid_.voxels_[VoxelGrid::voxel_index(*brick, z, bit)];
}

void VoxelWalk::step() {
    const int k = leave_.x <= leave_.y && leave_.x <= leave_.z ? 0 : leave_.y <= leave_.z ? 1 : 2;
    at_ = leave_[k];
    leave_[k] += width_[k];
    const auto axis = static_cast<size_t>(k);
    cell_[axis] += side_[axis];
}

bool VoxelWalk::next(Crossing& crossing) {
    while (at_ < end_) {
        const Voxel* occupied = voxel();
        const float begin = at_;
        step();
        if (!occupied) continue;
        crossing = {0.5f * (begin + at_), at_ - begin, occupied};
        return true;
    }
    return false;
}

}  // namespace covtrace
