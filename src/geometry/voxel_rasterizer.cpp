#include "geometry/voxel_rasterizer.h"

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
    normal_ = area / size;
    velocity_ = velocity;
    split({corners, size * weight});
}

void VoxelRasterizer::split(const Piece& piece) {
    const auto& p = piece.corners;
    for (int k = 0; k < 3; ++k) {
        const float lo = std::min({p[0][k], p[1][k], p[2][k]}),
                    hi = std::max({p[0][k], p[1][k], p[2][k]});
        if (hi < layout_.box.lo[k] || lo > layout_.box.hi[k]) return;
    }
    size_t longest = 0;
    float l2[3];
    for (size_t i = 0; i < 3; ++i) {
        l2[i] = length_squared(p[(i + 1) % 3] - p[i]);
        if (l2[i] > l2[longest]) longest = i;
    }
    // Halving the longest edge down to half a voxel gives 16 to 32 pieces per voxel of a plane, and
    // no more than it takes along slivers.
    if (l2[longest] <= 0.25f * layout_.size * layout_.size) return enter(piece);
    const Vec3 a = p[longest], b = p[(longest + 1) % 3], c = p[(longest + 2) % 3];
    const Vec3 middle = (a + b) * 0.5f;
    if (middle == a || middle == b) return enter(piece);
    split({{a, middle, c}, 0.5f * piece.area});
    split({{middle, b, c}, 0.5f * piece.area});
}

void VoxelRasterizer::enter(const Piece& piece) {
    const Vec3 center = (piece.corners[0] + piece.corners[1] + piece.corners[2]) * (1.0f / 3);
    int cell[3];
    Vec3 middle;
    for (int k = 0; k < 3; ++k) {
        if (center[k] < layout_.box.lo[k] || center[k] > layout_.box.hi[k]) return;
        cell[k] = static_cast<int>((center[k] - layout_.origin[k]) / layout_.size);
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
    const float w = piece.area;
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
