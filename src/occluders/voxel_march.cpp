/// The march along a segment through the voxel grid (`--occlusion grid`): of every few steps the
/// nearest voxel is one edge beside the segment. `VoxelWalk` is the way of `--occlusion voxels`.
#include <algorithm>
#include <bit>
#include <cmath>

#include "occluders/voxel_grid.h"

namespace covtrace {

namespace {

/// Bits of the columns x0..x1 in the rows y0..y1 of a word.
uint64_t rectangle(int x0, int x1, int y0, int y1) {
    const uint64_t row = (uint64_t{0xff} >> (7 - x1 + x0)) << x0;
    const uint64_t all = row * 0x0101010101010101u;
    return (all >> (8 * (7 - y1 + y0))) << (8 * y0);
}

constexpr int kSlab = 3;         ///< steps that share one event
constexpr float kEnds = 1.5f;    ///< voxels left out at either end
constexpr float kWidest = 3.0f;  ///< voxels, the largest radius
constexpr uint32_t kNoVoxel = ~uint32_t{0};

}  // namespace

VoxelMarch::VoxelMarch(const VoxelGrid& grid, Vec3 from, Vec3 to, float begin, float end)
    : grid_(grid) {
    const float total = distance(from, to), size = grid.size_;
    if (grid.voxels_.empty() || !(total > 2 * kEnds * size) || !std::isfinite(total)) return;
    direction_ = (to - from) / total;
    // The march is clipped to the box and a margin from which centroids within the box can be met.
    float enter = std::max(begin, kEnds * size), leave = std::min(end, total - kEnds * size);
    const float margin = kWidest * size;
    for (int k = 0; k < 3; ++k) {
        const float lo = grid.box_.lo[k] - margin - from[k],
                    hi = grid.box_.hi[k] + margin - from[k];
        if (direction_[k] == 0) {
            if (lo > 0 || hi < 0) return;
            continue;
        }
        const float a = lo / direction_[k], b = hi / direction_[k];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
    }
    if (!(leave > enter)) return;
    start_ = from + direction_ * enter;
    skipped_ = enter;
    length_ = leave - enter;
    steps_ = static_cast<int>(std::ceil(length_ / size));
}

bool VoxelMarch::next(float radius, OccluderEvent& event) {
    const float size = grid_.size_;
    radius = std::min(radius, kWidest * size);
    if (!(radius > 0)) return false;
    // The reach in voxels: a centroid within the radius and half a step of a point is at most so
    // far away.
    const float far = std::sqrt(sqr(radius / size) + 0.25f);
    const int reach = std::clamp(static_cast<int>(far) + 1, 1, VoxelGrid::kReach);
    while (step_ < steps_) {
        const float middle = (static_cast<float>(step_) + 0.5f) * size;
        const VoxelGrid::Cell cell = grid_.cell_of(start_ + direction_ * middle);
        const VoxelGrid::Brick* brick = grid_.brick_of(cell);
        if (!brick) {
            step_ = step_behind_brick(cell);
            continue;
        }
        const uint64_t word =
            brick->within[static_cast<size_t>(reach - 1)][static_cast<size_t>(cell.z & 7)];
        if (!(word >> ((cell.y & 7) * 8 + (cell.x & 7)) & 1)) {
            ++step_;
            continue;
        }
        // A slab starts where something is first seen, so that one edge does not fall into two of
        // them.
        const float begin = static_cast<float>(step_);
        Nearest nearest = nearest_in_slab(radius);
        if (nearest.voxel != kNoVoxel && nearest.first >= begin + 1) {
            step_ += static_cast<int>(nearest.first - begin);
            nearest = nearest_in_slab(radius);
        }
        step_ += kSlab;
        if (nearest.voxel == kNoVoxel) continue;
        const Voxel& v = grid_.voxels_[nearest.voxel];
        const Vec3 to_centroid = v.centroid - start_;
        const float s = dot(to_centroid, direction_);
        const Vec3 offset = to_centroid - direction_ * s;
        event = {skipped_ + s, offset, std::max(length(offset), 0.5f * size), v.normals,
                 v.velocity};
        return true;
    }
    return false;
}

VoxelMarch::Nearest VoxelMarch::nearest_in_slab(float radius) const {
    // Lengths below are in voxels, positions from the grid's corner on.
    const float scale = 1 / grid_.size_;
    const Vec3 start = (start_ - grid_.origin_) * scale, d = direction_;
    const auto begin = static_cast<float>(step_);
    const float end = std::min(begin + kSlab, length_ * scale), middle = 0.5f * (begin + end);
    radius *= scale;
    // The cells to look at are in the box of a cylinder about the slab.
    const auto half = [&](float c) {
        return 0.5f * (end - begin) * std::abs(c) + radius * safe_sqrt(1 - c * c);
    };
    const Vec3 center = start + d * middle, extent{half(d.x), half(d.y), half(d.z)};
    const auto cell = [](Vec3 p) {
        return VoxelGrid::Cell{static_cast<int>(std::floor(p.x)), static_cast<int>(std::floor(p.y)),
                               static_cast<int>(std::floor(p.z))};
    };
    const VoxelGrid::Cell lo = cell(center - extent), hi = cell(center + extent);
    const float widest = radius * radius;
    float best = widest;
    Nearest nearest{kNoVoxel, end};
    for (int bz = lo.z >> 3; bz <= hi.z >> 3; ++bz)
        for (int by = lo.y >> 3; by <= hi.y >> 3; ++by)
            for (int bx = lo.x >> 3; bx <= hi.x >> 3; ++bx) {
                const VoxelGrid::Brick* brick = grid_.brick_of({8 * bx, 8 * by, 8 * bz});
                if (!brick) continue;
                const uint64_t window =
                    rectangle(std::max(lo.x - 8 * bx, 0), std::min(hi.x - 8 * bx, 7),
                              std::max(lo.y - 8 * by, 0), std::min(hi.y - 8 * by, 7));
                const Vec3 corner =
                    Vec3{static_cast<float>(8 * bx), static_cast<float>(8 * by), 0} - start;
                for (int z = std::max(lo.z - 8 * bz, 0); z <= std::min(hi.z - 8 * bz, 7); ++z) {
                    uint64_t word = brick->occupied[static_cast<size_t>(z)] & window;
                    const float cz = static_cast<float>(8 * bz + z) + corner.z;
                    for (; word != 0; word &= word - 1) {
                        const int bit = std::countr_zero(word);
                        const uint32_t index = VoxelGrid::voxel_index(*brick, z, bit);
                        const VoxelGrid::Offset offset = grid_.offsets_[index];
                        const Vec3 c{
                            corner.x + static_cast<float>(bit & 7) + VoxelGrid::fraction(offset.x),
                            corner.y + static_cast<float>(bit >> 3) + VoxelGrid::fraction(offset.y),
                            cz + VoxelGrid::fraction(offset.z)};
                        const float s = dot(c, d);
                        const float r2 = length_squared(c - d * s);
                        if (!(s >= begin && s < end && r2 < widest)) continue;
                        nearest.first = std::min(nearest.first, s);
                        if (!(r2 < best)) continue;
                        best = r2;
                        nearest.voxel = index;
                    }
                }
            }
    return nearest;
}

int VoxelMarch::step_behind_brick(VoxelGrid::Cell cell) const {
    const float size = grid_.size_;
    float leave = kInfinity;
    const int corner[3] = {cell.x & ~7, cell.y & ~7, cell.z & ~7};
    for (int k = 0; k < 3; ++k) {
        if (direction_[k] == 0) continue;
        const int side = corner[k] + (direction_[k] > 0 ? 8 : 0);
        const float plane = grid_.origin_[k] + static_cast<float>(side) * size;
        leave = std::min(leave, (plane - start_[k]) / direction_[k]);
    }
    const float steps = std::ceil(leave / size - 0.5f);
    return std::max(step_ + 1,
                    steps < static_cast<float>(steps_) ? static_cast<int>(steps) : steps_);
}

}  // namespace covtrace
