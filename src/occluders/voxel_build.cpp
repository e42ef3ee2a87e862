/// The voxel grid's construction from the scene's triangles.
#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <new>

#include "core/error.h"
#include "core/parallel.h"
#include "geometry/tessellation.h"
#include "occluders/core_bounds.h"
#include "occluders/occurrences.h"
#include "occluders/voxel_grid.h"
#include "occluders/voxel_rasterizer.h"

namespace covtrace {

namespace {

constexpr size_t kBatch = 2048;  ///< triangles
constexpr size_t kMostInstancedTriangles = 1 << 24;

/// A run of triangles that one thread enters in one go.
struct Batch {
    const Occurrence* occurrence;
    const Tessellation* surface;
    size_t begin, end, stride;
};

/// Spreads every bit of 24x24 rows of 24 bits to its 26 neighbours.
using Rows = std::array<uint32_t, 24 * 24>;
void dilate(Rows& rows) {
    constexpr size_t n = 24;
    for (uint32_t& r : rows) r |= r << 1 | r >> 1;
    const Rows along_x = rows;
    for (size_t i = 0; i < rows.size(); ++i)
        rows[i] |= (i % n > 0 ? along_x[i - 1] : 0) | (i % n + 1 < n ? along_x[i + 1] : 0);
    const Rows along_xy = rows;
    for (size_t i = 0; i < rows.size(); ++i)
        rows[i] |= (i >= n ? along_xy[i - n] : 0) | (i + n < rows.size() ? along_xy[i + n] : 0);
}

}  // namespace

class VoxelGridBuilder {
  public:
    VoxelGridBuilder(VoxelGrid& grid, const Geometry& geometry, const VoxelGridOptions& options)
        : grid_(grid), geometry_(geometry.impl()), options_(options) {
        if (options.width < 1 || options.width > 2048)
            throw Error(ErrorKind::limit, "the voxel grid's width must be between 1 and 2048");
        lay_out();
        collect(std::max(1, options.shutter_samples));
        rasterize();
        if (is_cancelled()) return;
        sort_into_bricks();
        fill_bricks();
        mark_neighbourhoods();
    }

  private:
    bool is_cancelled() const { return options_.cancelled && options_.cancelled(); }

    /// The bounds of the scene, without far outliers if it has any.
    Bounds3 scene_box() const {
        const Bounds3 all = geometry_.bounds;
        const Bounds3 core = core_bounds(geometry_);
        const auto longest = [](const Bounds3& b) {
            const Vec3 d = b.diagonal();
            return std::max({d.x, d.y, d.z});
        };
        if (core.empty() || longest(all) <= static_cast<float>(options_.width) * longest(core))
            return all;
        const Vec3 margin = Vec3{1, 1, 1} * longest(core);
        return {max(all.lo, core.lo - margin), min(all.hi, core.hi + margin)};
    }

    void lay_out() {
        const Bounds3 box = options_.box.empty() ? scene_box() : options_.box;
        const Vec3 d = box.diagonal();
        const float longest = std::max({d.x, d.y, d.z});
        const float size = longest > 0 ? longest / static_cast<float>(options_.width) : 1.0f;
        layout_.size = size;
        layout_.box = box;
        layout_.origin = box.lo - Vec3{8 * size, 8 * size, 8 * size};
        for (int k = 0; k < 3; ++k)
            layout_.bricks[static_cast<size_t>(k)] =
                static_cast<int>(std::floor(d[k] / size)) / 8 + 3;
        grid_.size_ = size;
        grid_.box_ = box;
        grid_.origin_ = layout_.origin;
        grid_.bricks_ = layout_.bricks;
        grid_.top_.assign(static_cast<size_t>(layout_.bricks[0]) *
                              static_cast<size_t>(layout_.bricks[1]) *
                              static_cast<size_t>(layout_.bricks[2]),
                          -1);
    }

    void collect(int times) {
        const ShutterClock& clock = geometry_.clock;
        for (int i = 0; i < times; ++i) {
            const float f = (static_cast<float>(i) + 0.5f) / static_cast<float>(times);
            for (const Occurrence& o :
                 occurrences(geometry_, clock.open() + f * (clock.close() - clock.open())))
                if (o.moves || i == 0) {
                    occurrences_.push_back(o);
                    weights_.push_back(o.moves ? 1.0f / static_cast<float>(times) : 1.0f);
                }
        }
        // Each shape gets one tessellation, fine enough for the largest of its occurrences.
        const LocalShape* first = geometry_.local.data();
        std::vector<double> scales(geometry_.local.size(), 0);
        std::vector<const Occurrence*> firsts(scales.size(), nullptr);
        for (const Occurrence& o : occurrences_) {
            const Affine& m = o.world_from_local;
            const auto shape = static_cast<size_t>(o.shape - first);
            if (!firsts[shape]) firsts[shape] = &o;
            double& scale = scales[shape];
            scale = std::max({scale, length(m.row[0]), length(m.row[1]), length(m.row[2])});
        }
        surfaces_.resize(scales.size());
        for (size_t i = 0; i < scales.size(); ++i)
            if (scales[i] > 0) surfaces_[i] = tessellate(i, scales[i], *firsts[i]);
    }

    /// Makes the triangles of a shape. Holes of alpha textures that depend on the position are
    /// those of the `first` occurrence.
    std::unique_ptr<Tessellation> tessellate(size_t shape, double scale,
                                             const Occurrence& first) const {
        const LocalShape& local = geometry_.local[shape];
        const TextureId texture = geometry_.placed[shape].description.alpha;
        if (texture < 0 || !geometry_.alpha)
            return std::make_unique<Tessellation>(local, layout_.size, scale);
        return std::make_unique<Tessellation>(
            local, layout_.size, scale, [&](const SurfacePoint& p) {
                const Vec3 at = first.world_from_local.point(p.position).to_float();
                const Vec3 normal = normalize(first.world_from_local.normal(p.ng)).to_float();
                return geometry_.alpha(texture, {p.uv, at, p.vertices, normal});
            });
    }

    const Tessellation& surface_of(const Occurrence& o) const {
        return *surfaces_[static_cast<size_t>(o.shape - geometry_.local.data())];
    }

    std::vector<Batch> batches() const {
        size_t instanced = 0;
        for (const Occurrence& o : occurrences_)
            if (o.is_instanced) instanced += surface_of(o).size();
        const size_t stride = instanced / kMostInstancedTriangles + 1;
        std::vector<Batch> all;
        for (const Occurrence& o : occurrences_) {
            const Tessellation& surface = surface_of(o);
            const size_t count = surface.size(), step = o.is_instanced ? stride : 1;
            // A few triangles may be large ones, so they are spread over several batches, too.
            const size_t batch = std::clamp<size_t>(count / 4, 1, kBatch) * step;
            for (size_t i = 0; i < count; i += batch)
                all.push_back({&o, &surface, i, std::min(count, i + batch), step});
        }
        return all;
    }

    void rasterize() {
        const std::vector<Batch> all = batches();
        entries_.resize(all.size());
        parallel_for(static_cast<int64_t>(all.size()), [&](int64_t b) {
            const Batch& batch = all[static_cast<size_t>(b)];
            const Occurrence& o = *batch.occurrence;
            const float weight = weights_[static_cast<size_t>(&o - occurrences_.data())] *
                                 static_cast<float>(batch.stride);
            VoxelRasterizer rasterizer(layout_);
            for (size_t i = batch.begin; i < batch.end && !is_cancelled(); i += batch.stride) {
                std::array<Vec3, 3> corners = (*batch.surface)[i];
                for (Vec3& p : corners) p = o.world_from_local.point(Vec3d(p)).to_float();
                rasterizer.add(corners, o.moves ? &o.velocity : nullptr, weight);
            }
            entries_[static_cast<size_t>(b)] = rasterizer.take();
        });
    }

    /// Sorts entries by brick, within it in the order of the batches, so that every sum has one
    /// order.
    void sort_into_bricks() {
        std::vector<uint32_t> count(grid_.top_.size() + 1, 0);
        for (const auto& batch : entries_)
            for (const VoxelEntry& e : batch) ++count[e.key / 512 + 1];
        for (size_t place = 0; place + 1 < count.size(); ++place)
            if (count[place + 1] > 0) occupied_.push_back(place);
        for (size_t i = 1; i < count.size(); ++i) count[i] += count[i - 1];
        sorted_.resize(count.back());
        range_of_ = count;
        for (const auto& batch : entries_)
            for (const VoxelEntry& e : batch) sorted_[count[e.key / 512]++] = &e;
    }

    void fill_bricks() {
        grid_.stored_.resize(occupied_.size());
        std::vector<std::vector<Voxel>> found(occupied_.size());
        parallel_for(static_cast<int64_t>(occupied_.size()), [&](int64_t i) {
            const auto b = static_cast<size_t>(i);
            found[b] = fill_brick(occupied_[b], grid_.stored_[b]);
        });
        for (size_t b = 0; b < occupied_.size(); ++b) {
            grid_.top_[occupied_[b]] = static_cast<int32_t>(b);
            grid_.stored_[b].first = static_cast<uint32_t>(grid_.voxels_.size());
            grid_.voxels_.insert(grid_.voxels_.end(), found[b].begin(), found[b].end());
        }
        grid_.voxels_.shrink_to_fit();
        grid_.offsets_.resize(grid_.voxels_.size());
        for (size_t i = 0; i < grid_.voxels_.size(); ++i) {
            const Vec3 p = (grid_.voxels_[i].centroid - layout_.origin) / layout_.size;
            const auto part = [](float v) {
                return static_cast<uint8_t>(std::clamp((v - std::floor(v)) * 256, 0.0f, 255.0f));
            };
            grid_.offsets_[i] = {part(p.x), part(p.y), part(p.z)};
        }
    }

    std::array<int, 3> place_of(size_t place) const {
        const auto nx = static_cast<size_t>(layout_.bricks[0]),
                   ny = static_cast<size_t>(layout_.bricks[1]);
        return {static_cast<int>(place % nx), static_cast<int>(place / nx % ny),
                static_cast<int>(place / (nx * ny))};
    }

    std::vector<Voxel> fill_brick(size_t place, VoxelGrid::Brick& brick) const {
        std::array<VoxelSums, 512> sums{};
        for (uint32_t i = range_of_[place]; i < range_of_[place + 1]; ++i)
            sums[sorted_[i]->key % 512].add(sorted_[i]->sums);
        const std::array<int, 3> at = place_of(place);
        std::vector<Voxel> voxels;
        for (size_t k = 0; k < 512; ++k) {
            if (k % 64 == 0) brick.rank[k / 64] = static_cast<uint16_t>(voxels.size());
            const VoxelSums& s = sums[k];
            if (!(s.area > 0)) continue;
            brick.occupied[k / 64] |= uint64_t{1} << (k % 64);
            const auto middle = [&](int axis, size_t index) {
                return layout_.origin[axis] +
                       (static_cast<float>(8 * at[static_cast<size_t>(axis)] +
                                           static_cast<int>(index)) +
                        0.5f) *
                           layout_.size;
            };
            const float w = 1 / s.area;
            Voxel v;
            v.area = s.area;
            v.centroid =
                Vec3{middle(0, k % 8), middle(1, k / 8 % 8), middle(2, k / 64)} + s.position * w;
            v.velocity = s.velocity * w;
            v.normals = {s.normals.xx * w, s.normals.xy * w, s.normals.xz * w,
                         s.normals.yy * w, s.normals.yz * w, s.normals.zz * w};
            voxels.push_back(v);
        }
        return voxels;
    }

    /// Stores the empty bricks beside occupied ones, too, and marks in all bricks which voxels have
    /// something near (Brick::within).
    void mark_neighbourhoods() {
        std::vector<size_t> places = occupied_;
        for (size_t place : occupied_) {
            const std::array<int, 3> at = place_of(place);
            for (int dz = -1; dz <= 1; ++dz)
                for (int dy = -1; dy <= 1; ++dy)
                    for (int dx = -1; dx <= 1; ++dx) {
                        const size_t other = neighbour(at, dx, dy, dz);
                        if (other == kNone || grid_.top_[other] >= 0) continue;
                        grid_.top_[other] = static_cast<int32_t>(places.size());
                        places.push_back(other);
                    }
        }
        grid_.stored_.resize(places.size());
        grid_.stored_.shrink_to_fit();
        parallel_for(static_cast<int64_t>(places.size()), [&](int64_t i) {
            mark_brick(places[static_cast<size_t>(i)], grid_.stored_[static_cast<size_t>(i)]);
        });
    }

    static constexpr size_t kNone = ~size_t{0};
    size_t neighbour(const std::array<int, 3>& at, int dx, int dy, int dz) const {
        const int x = at[0] + dx, y = at[1] + dy, z = at[2] + dz;
        if (x < 0 || y < 0 || z < 0 || x >= layout_.bricks[0] || y >= layout_.bricks[1] ||
            z >= layout_.bricks[2])
            return kNone;
        return static_cast<size_t>((z * layout_.bricks[1] + y) * layout_.bricks[0] + x);
    }

    void mark_brick(size_t place, VoxelGrid::Brick& brick) const {
        Rows rows{};
        const std::array<int, 3> at = place_of(place);
        for (int dz = -1; dz <= 1; ++dz)
            for (int dy = -1; dy <= 1; ++dy)
                for (int dx = -1; dx <= 1; ++dx) {
                    const size_t other = neighbour(at, dx, dy, dz);
                    if (other == kNone || grid_.top_[other] < 0) continue;
                    const VoxelGrid::Brick& from =
                        grid_.stored_[static_cast<size_t>(grid_.top_[other])];
                    for (int z = 0; z < 8; ++z)
                        for (int y = 0; y < 8; ++y) {
                            const auto bits = static_cast<uint32_t>(
                                from.occupied[static_cast<size_t>(z)] >> (8 * y) & 255);
                            rows[static_cast<size_t>((8 * (dz + 1) + z) * 24 + 8 * (dy + 1) + y)] |=
                                bits << (8 * (dx + 1));
                        }
                }
        for (VoxelGrid::Bits& within : brick.within) {
            dilate(rows);
            for (int z = 0; z < 8; ++z)
                for (int y = 0; y < 8; ++y)
                    within[static_cast<size_t>(z)] |=
                        uint64_t{rows[static_cast<size_t>((8 + z) * 24 + 8 + y)] >> 8 & 255}
                        << (8 * y);
        }
    }

    VoxelGrid& grid_;
    const Geometry::Impl& geometry_;
    const VoxelGridOptions& options_;
    VoxelLayout layout_;
    std::vector<Occurrence> occurrences_;
    std::vector<float> weights_;  ///< for the occurrence of the same index
    std::vector<std::unique_ptr<Tessellation>> surfaces_;
    std::vector<std::vector<VoxelEntry>> entries_;  ///< for each batch
    std::vector<size_t> occupied_;                  ///< places of bricks with anything in them
    std::vector<const VoxelEntry*> sorted_;
    std::vector<uint32_t> range_of_;  ///< where a place's entries begin in sorted_
};

VoxelGrid::VoxelGrid(const Geometry& geometry, const VoxelGridOptions& options) {
    try {
        VoxelGridBuilder(*this, geometry, options);
    } catch (const std::bad_alloc&) {
        throw Error(ErrorKind::limit, "out of memory while building the voxel grid");
    }
}

}  // namespace covtrace
