#include "occluders/voxel_rasterizer.h"

#include <algorithm>
#include <cmath>

namespace covtrace {

void VoxelSums::add(const VoxelSums& o) {
    area += o.area;
    position += o.position;
    velocity += o.velocity;
    normals.xx += o.normals.xx, normals.xy += o.normals.xy, normals.xz += o.normals.xz;
    normals.yy += o.normals.yy, normals.yz += o.normals.yz, normals.zz += o.normals.zz;
}

void VoxelRasterizer::add(const std::array<Vec3, 3>& corners, const Affine* velocity,
                          float weight) {
    const Vec3 area = 0.5f * cross(corners[1] - corners[0], corners[2] - corners[0]);
    const float size = length(area);
    if (!(size > 0) || !std::isfinite(size)) return;
    Bounds3 bounds;
    for (Vec3 p : corners) bounds.extend(p);
    const Bounds3& box = layout_.box;
    for (int k = 0; k < 3; ++k)
        if (bounds.hi[k] < box.lo[k] || bounds.lo[k] > box.hi[k]) return;
    normal_ = area / size;
    velocity_ = velocity;
    split(corners[0], corners[1], corners[2], size * weight);
}

void VoxelRasterizer::split(Vec3 a, Vec3 b, Vec3 c, float area) {
    // Halving the longest edge down to half a voxel gives 16 to 32 pieces per voxel of a plane, and
    // no more than it takes along slivers.
    const float ab = length_squared(b - a), bc = length_squared(c - b), ca = length_squared(a - c);
    const float longest = std::max({ab, bc, ca});
    if (longest <= 0.25f * layout_.size * layout_.size)
        return enter((a + b + c) * (1.0f / 3), area);
    if (longest == bc) {
        const Vec3 first = a;
        a = b, b = c, c = first;
    } else if (longest == ca) {
        const Vec3 last = c;
        c = b, b = a, a = last;
    }
    const Vec3 middle = (a + b) * 0.5f;
    // A piece is entered at once where single precision has no more room between its corners.
    if (middle == a || middle == b) return enter((a + b + c) * (1.0f / 3), area);
    if (longest > sqr(16 * layout_.size)) {
        const Vec3 lo = min(a, min(b, c)), hi = max(a, max(b, c));
        for (int k = 0; k < 3; ++k)
            if (hi[k] < layout_.box.lo[k] || lo[k] > layout_.box.hi[k]) return;
    }
    split(a, middle, c, 0.5f * area);
    split(middle, b, c, 0.5f * area);
}

void VoxelRasterizer::enter(Vec3 center, float area) {
    int cell[3];
    Vec3 middle;
    const float per_voxel = 1 / layout_.size;
    for (int k = 0; k < 3; ++k) {
        if (center[k] < layout_.box.lo[k] || center[k] > layout_.box.hi[k]) return;
        cell[k] = static_cast<int>((center[k] - layout_.origin[k]) * per_voxel);
        cell[k] = std::clamp(cell[k], 0, layout_.bricks[static_cast<size_t>(k)] * 8 - 1);
        middle[k] = layout_.origin[k] + (static_cast<float>(cell[k]) + 0.5f) * layout_.size;
    }
    const auto nx = static_cast<uint64_t>(layout_.bricks[0]),
               ny = static_cast<uint64_t>(layout_.bricks[1]);
    const auto at = [&cell](int k) { return static_cast<uint64_t>(cell[k]); };
    const uint64_t place = ((at(2) / 8) * ny + at(1) / 8) * nx + at(0) / 8;
    const uint64_t key = place * 512 + (at(2) % 8) * 64 + (at(1) % 8) * 8 + at(0) % 8;
    if (key != last_key_) {
        const auto [found, is_new] =
            index_.try_emplace(key, static_cast<uint32_t>(entries_.size()));
        if (is_new) entries_.push_back({key, {}});
        last_key_ = key;
        last_ = found->second;
    }
    const float w = area;
    const Vec3 n = normal_;
    VoxelSums s;
    s.area = w;
    s.position = (center - middle) * w;
    if (velocity_) s.velocity = velocity_->point(Vec3d(center)).to_float() * w;
    s.normals = {w * n.x * n.x, w * n.x * n.y, w * n.x * n.z,
                 w * n.y * n.y, w * n.y * n.z, w * n.z * n.z};
    entries_[last_].sums.add(s);
}

std::vector<VoxelEntry> VoxelRasterizer::take() {
    index_.clear();
    last_key_ = ~uint64_t{0};
    return std::move(entries_);
}

}  // namespace covtrace
