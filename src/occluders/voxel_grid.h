/// The scene's surfaces in coarse voxels: occluders of a bundle of rays that passes by. They serve
/// the occlusion term of the frequency analysis alone; radiance never depends on them. Only bricks
/// of 8^3 voxels near a surface are stored, and in these only the occupied voxels.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/vec.h"
#include "geometry/geometry.h"

namespace covtrace {

/// Symmetric 3x3 tensor: the mean of n n^T over unit normals n, so that its trace is 1.
struct NormalTensor {
    float xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
};

/// The surfaces within one voxel, averaged over area.
struct Voxel {
    NormalTensor normals;
    Vec3 centroid;
    Vec3 velocity;  ///< of the surface, scene units per unit of the scene's time
    float area = 0;
};

struct VoxelGridOptions {
    int width = 200;  ///< voxels along the longest side of the box
    int shutter_samples =
        1;  ///< times, spread over the shutter, at which moving shapes are entered
    /// Box that the voxels divide; surfaces outside of it are ignored. Empty: Geometry::bounds(),
    /// or a smaller box where a few far corners would leave all the rest in one voxel.
    Bounds3 box{};
    /// Tells whether to stop; asked from all threads. Once it says yes the constructor soon
    /// returns, and the grid is empty.
    std::function<bool()> cancelled{};
};

class VoxelGrid {
  public:
    /// Enters all surfaces but interfaces. The result is the same for any number of threads. Where
    /// instances hold more than 2^24 triangles, only every k-th of them is entered, with k times
    /// its area. Throws Error(limit) where the width is not in [1, 2048].
    explicit VoxelGrid(const Geometry& geometry, const VoxelGridOptions& options = {});

    float voxel_size() const { return size_; }
    /// Longest side of the box that the voxels divide.
    float longest_side() const;
    size_t occupied_voxels() const { return voxels_.size(); }
    size_t memory() const;  ///< bytes
    /// The occupied voxel around a point, or null.
    const Voxel* find(Vec3 point) const;

  private:
    friend class VoxelMarch;
    friend class VoxelWalk;
    friend class VoxelGridBuilder;

    static constexpr int kReach = 4;  ///< voxels, the largest distance of Brick::within

    /// A bit for each voxel of a brick: bit y * 8 + x of word z stands for voxel (x, y, z).
    using Bits = std::array<uint64_t, 8>;
    struct Brick {
        Bits occupied{};
        /// Voxels near an occupied one: within[d - 1] has those within a Chebyshev distance of d
        /// voxels.
        std::array<Bits, kReach> within{};
        uint32_t first = 0;              ///< into voxels_
        std::array<uint16_t, 8> rank{};  ///< occupied voxels of this brick before word z
    };
    struct Cell {
        int x = 0, y = 0, z = 0;
    };

    Cell cell_of(Vec3 point) const;
    /// Brick that holds the voxel `cell`; null where it is empty or outside.
    const Brick* brick_of(Cell cell) const;
    /// Index into voxels_ and offsets_ of an occupied voxel of a brick.
    static uint32_t voxel_index(const Brick& brick, int z, int bit) {
        const uint64_t below = brick.occupied[static_cast<size_t>(z)] & ((uint64_t{1} << bit) - 1);
        return brick.first + brick.rank[static_cast<size_t>(z)] +
               static_cast<uint32_t>(std::popcount(below));
    }
    /// Place of a centroid in its voxel, in 256 parts: small enough to stay in the cache.
    struct Offset {
        uint8_t x = 0, y = 0, z = 0;
    };
    static float fraction(uint8_t offset) {
        return (static_cast<float>(offset) + 0.5f) * (1.0f / 256);
    }

    float size_ = 1;
    Vec3 origin_;  ///< corner of voxel (0, 0, 0), one empty brick outside the box
    Bounds3 box_;
    std::array<int, 3> bricks_{0, 0, 0};
    std::vector<int32_t> top_;  ///< brick of each place, -1 for none; x fastest
    std::vector<Brick> stored_;
    std::vector<Voxel> voxels_;
    std::vector<Offset> offsets_;  ///< of the voxel of the same index
};

/// A place where something passes close to a ray.
struct OccluderEvent {
    float s = 0;  ///< distance from the start of the march
    Vec3 offset;  ///< from the ray's point at `s` to the occluder's centroid; perpendicular to the
                  ///< ray
    float distance = 0;  ///< length of `offset`, at least half a voxel
    NormalTensor normals;
    Vec3 velocity;
};

/// Walks a segment and stops at the occluders beside it. The first and last 1.5 voxels are left
/// out: there lie the surfaces that the segment starts and ends on. No heap use.
///
///     VoxelMarch march(grid, from, to);
///     for (OccluderEvent e; march.next(radius, e);) …
class VoxelMarch {
  public:
    /// Prepares a march from `from` to `to`; it looks only at the part between the distances
    /// `begin` and `end` from `from`.
    VoxelMarch(const VoxelGrid& grid, Vec3 from, Vec3 to, float begin = 0, float end = kInfinity);
    /// The next occluder whose centroid is within `radius` of the ray (a radius above 3 voxels
    /// counts as 3); false at the end. Per 3 voxels of the way it gives the nearest one only: an
    /// edge that runs along the ray would be counted many times otherwise. `radius` may change from
    /// call to call.
    bool next(float radius, OccluderEvent& event);

  private:
    struct Nearest {
        uint32_t voxel = 0;
        float first = 0;  ///< step at which the march meets anything first
    };
    /// The voxel nearest to the ray in the slab that starts at step_, within `radius`.
    Nearest nearest_in_slab(float radius) const;
    /// The first step behind the empty brick that holds `cell`.
    int step_behind_brick(VoxelGrid::Cell cell) const;

    const VoxelGrid& grid_;
    Vec3 start_, direction_;  ///< step 0 begins at `start_`
    float skipped_ = 0;       ///< distance from the start of the segment to `start_`
    float length_ = 0;        ///< length of the march from `start_` on
    int step_ = 0, steps_ = 0;
};

}  // namespace covtrace
