#include <algorithm>
#include <bit>
#include <cmath>

#include "geometry/voxel_grid.h"

namespace covtrace {

namespace {

/// Bits of the columns x0..x1 of the rows y0..y1 of a word.
uint64_t rectangle(int x0, int x1, int y0, int y1) {
    const uint64_t row = (uint64_t{0xff} >> (7 - x1 + x0)) << x0;
    const uint64_t all = row * 0x0101010101010101u;
    return (all >> (8 * (7 - y1 + y0))) << (8 * y0);
}

constexpr int kSlab = 3;        ///< steps that share one event
constexpr float kEnds = 1.5f;   ///< voxels left out at either end
constexpr float kWidest = 3.0f;  ///< voxels, the largest radius

}  // namespace

VoxelMarch::VoxelMarch(const VoxelGrid& grid, Vec3 from, Vec3 to) : grid_(grid) {
    const float total = distance(from, to), size = grid.size_;
    if (grid.voxels_.empty() || !(total > 2 * kEnds * size) || !std::isfinite(total)) return;
    direction_ = (to - from) / total;
    // Clipped to the box and what can see into it.
    float enter = kEnds * size, leave = total - kEnds * size;
    const float margin = kWidest * size;
    for (int k = 0; k < 3; ++k) {
        const float lo = grid.box_.lo[k] - margin - from[k], hi = grid.box_.hi[k] + margin - from[k];
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
    // A centroid within the radius and half a step of a point is at most this many voxels away.
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
        const uint64_t word = brick->within[static_cast<size_t>(reach - 1)][static_cast<size_t>(cell.z & 7)];
        if (!(word >> ((cell.y & 7) * 8 + (cell.x & 7)) & 1) || !nearest_in_step(step_, radius, event)) {
            ++step_;
            continue;
        }
        for (int i = 1; i < kSlab && step_ + i < steps_; ++i)
            nearest_in_step(step_ + i, event.distance, event);
        step_ += kSlab;
        event.distance = std::max(event.distance, 0.5f * size);
        return true;
    }
    return false;
}

bool VoxelMarch::nearest_in_step(int step, float radius, OccluderEvent& event) const {
    const float size = grid_.size_;
    const float begin = static_cast<float>(step) * size, end = std::min(begin + size, length_);
    // The box of a cylinder about the step.
    const Vec3 middle = start_ + direction_ * (begin + 0.5f * size);
    const auto half = [&](float d) { return 0.5f * size * std::abs(d) + radius * safe_sqrt(1 - d * d); };
    const Vec3 extent{half(direction_.x), half(direction_.y), half(direction_.z)};
    const VoxelGrid::Cell lo = grid_.cell_of(middle - extent), hi = grid_.cell_of(middle + extent);
    float best = radius * radius;
    bool found = false;
    for (int bz = lo.z >> 3; bz <= hi.z >> 3; ++bz)
        for (int by = lo.y >> 3; by <= hi.y >> 3; ++by)
            for (int bx = lo.x >> 3; bx <= hi.x >> 3; ++bx) {
                const VoxelGrid::Brick* brick = grid_.brick_of({8 * bx, 8 * by, 8 * bz});
                if (!brick) continue;
                const uint64_t window =
                    rectangle(std::max(lo.x - 8 * bx, 0), std::min(hi.x - 8 * bx, 7),
                              std::max(lo.y - 8 * by, 0), std::min(hi.y - 8 * by, 7));
                for (int z = std::max(lo.z - 8 * bz, 0); z <= std::min(hi.z - 8 * bz, 7); ++z) {
                    uint64_t word = brick->occupied[static_cast<size_t>(z)] & window;
                    for (; word != 0; word &= word - 1) {
                        const Voxel& v = grid_.voxel(*brick, z, std::countr_zero(word));
                        const Vec3 to_centroid = v.centroid - start_;
                        const float s = dot(to_centroid, direction_);
                        if (!(s >= begin && s < end)) continue;
                        const Vec3 offset = to_centroid - direction_ * s;
                        const float r2 = length_squared(offset);
                        if (!(r2 < best)) continue;
                        best = r2;
                        found = true;
                        event = {skipped_ + s, offset, std::sqrt(r2), v.normals, v.velocity};
                    }
                }
            }
    return found;
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
    return std::max(step_ + 1, steps < static_cast<float>(steps_) ? static_cast<int>(steps) : steps_);
}

}  // namespace covtrace
