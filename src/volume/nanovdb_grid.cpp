#include "volume/nanovdb_grid.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <new>
#include <optional>
#include <sstream>
#include <type_traits>

#include "core/memory_limit.h"

#define NANOVDB_USE_ZIP 1
#define NANOVDB_USE_BLOSC 1
#include <nanovdb/NanoVDB.h>
#include <nanovdb/util/IO.h>

namespace covtrace {

namespace {

Error refusal(const SourceLocation& where, const std::string& text) {
    return {ErrorKind::scene, where, text};
}

/// Whether all nodes of a grid lie within its bytes, one after the other: the library follows the
/// offsets of a file without looking at them.
template <class Grid>
bool is_sound(const Grid& grid, size_t bytes) {
    const auto* begin = reinterpret_cast<const uint8_t*>(&grid);
    const auto lies_within = [&](const void* node, size_t size) {
        const auto at = reinterpret_cast<uintptr_t>(node) - reinterpret_cast<uintptr_t>(begin);
        return at < bytes && size <= bytes - at &&
               reinterpret_cast<uintptr_t>(node) % NANOVDB_DATA_ALIGNMENT == 0;
    };
    if (bytes < sizeof(Grid) + sizeof(grid.tree()) || grid.gridSize() > bytes) return false;
    if (!lies_within(&grid.tree(), sizeof(grid.tree()))) return false;
    const auto& root = grid.tree().root();
    if (!lies_within(&root, sizeof(root))) return false;
    using Root = std::decay_t<decltype(root)>;
    using Tile = typename Root::Tile;
    const size_t tiles = root.data()->mTableSize;
    if (tiles > bytes / sizeof(Tile) || !lies_within(&root, sizeof(root) + tiles * sizeof(Tile)))
        return false;
    for (uint32_t i = 0; i < tiles; ++i) {
        const auto* tile = root.data()->tile(i);
        if (!tile->isChild()) continue;
        const auto* upper = root.data()->getChild(tile);
        if (!lies_within(upper, sizeof(*upper))) return false;
        for (auto u = upper->beginChild(); u; ++u) {
            const auto& lower = *u;
            if (!lies_within(&lower, sizeof(lower))) return false;
            for (auto l = lower.beginChild(); l; ++l) {
                const auto& leaf = *l;
                if (!lies_within(&leaf, sizeof(leaf)) ||
                    !lies_within(&leaf, leaf.data()->memUsage()))
                    return false;
            }
        }
    }
    return true;
}

/// Takes points of the file's world to the grid's lattice.
template <class Grid>
std::optional<Transform> lattice_from_file(const Grid& grid) {
    const auto image = [&](double x, double y, double z) {
        return grid.worldToIndex(nanovdb::Vec3d(x, y, z));
    };
    const auto origin = image(0, 0, 0);
    const std::array<nanovdb::Vec3d, 3> axes{image(1, 0, 0), image(0, 1, 0), image(0, 0, 1)};
    Matrix4 m;
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) m.m[size_t(r)][size_t(c)] = axes[size_t(c)][r] - origin[r];
        m.m[size_t(r)][3] = origin[r];
    }
    return Transform::from_matrix(m);
}

template <class Value>
std::shared_ptr<const DensityGrid> densities(const nanovdb::NanoGrid<Value>& grid, size_t bytes,
                                             const Transform& file_from_world,
                                             const SourceLocation& where) {
    if (!is_sound(grid, bytes)) throw refusal(where, "the file is damaged: a node lies outside");
    const auto lattice_from_world = lattice_from_file(grid);
    if (!lattice_from_world) throw refusal(where, "the grid's own transform is singular");
    if (grid.activeVoxelCount() == 0) throw refusal(where, "the grid is empty");
    const nanovdb::CoordBBox box = grid.indexBBox();
    // Sums and blocks of such places stay within whole numbers
    constexpr int kFarthest = 1 << 28;
    LatticePlace first, last;
    for (int a = 0; a < 3; ++a) {
        first[size_t(a)] = box.min()[a];
        last[size_t(a)] = box.max()[a];
        if (box.min()[a] < -kFarthest || box.max()[a] > kFarthest || box.min()[a] > box.max()[a])
            throw refusal(where, "the grid's bounds are out of range");
    }
    const Bounds3 bounds{{float(first[0]), float(first[1]), float(first[2])},
                         {float(last[0] + 1), float(last[1] + 1), float(last[2] + 1)}};
    const auto accessor = grid.getAccessor();
    const auto value = [&](const LatticePlace& p) {
        const float v = float(accessor.getValue(nanovdb::Coord(p[0], p[1], p[2])));
        return v > 0 && v <= std::numeric_limits<float>::max() ? v : 0.0f;
    };
    // Values of places that share their numbers but for the last three bits are in one leaf, or all
    // the same
    const auto is_empty = [&](const LatticePlace& from, const LatticePlace& to) {
        for (int i = 0; i < 8; ++i) {
            const LatticePlace p{(i & 1) ? to[0] : from[0], (i & 2) ? to[1] : from[1],
                                 (i & 4) ? to[2] : from[2]};
            if (accessor.probeLeaf(nanovdb::Coord(p[0], p[1], p[2])) || value(p) > 0) return false;
        }
        return true;
    };
    return std::make_shared<const DensityGrid>(*lattice_from_world * file_from_world, bounds,
                                               Lattice{first, last, value, is_empty});
}

}  // namespace

std::shared_ptr<const DensityGrid> read_nanovdb(const std::string& bytes, const std::string& name,
                                                const Transform& file_from_world,
                                                const SourceLocation& where) {
    nanovdb::GridHandle<nanovdb::HostBuffer> handle;
    try {
        std::istringstream metadata(bytes), grids(bytes);
        size_t size = 0;
        bool is_there = false;
        for (const auto& grid : nanovdb::io::readGridMetaData(metadata))
            if (grid.gridName == name) {
                is_there = true;
                size = std::max<size_t>(size, grid.gridSize);
            }
        if (!is_there) return nullptr;
        const MemoryReservation room(size, "a grid of densities", where);
        handle = nanovdb::io::readGrid(grids, name);
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw Error(ErrorKind::limit, where, "there is no memory for the grid");
    } catch (const std::exception& e) {
        std::string text = e.what();
        std::ranges::replace(text, '\n', ' ');
        throw refusal(where, "the file is no grid of NanoVDB that can be read: " + text);
    }
    const size_t size = handle.size();
    if (const auto* grid = handle.grid<float>())
        return densities(*grid, size, file_from_world, where);
    if (const auto* grid = handle.grid<nanovdb::Fp4>())
        return densities(*grid, size, file_from_world, where);
    if (const auto* grid = handle.grid<nanovdb::Fp8>())
        return densities(*grid, size, file_from_world, where);
    if (const auto* grid = handle.grid<nanovdb::Fp16>())
        return densities(*grid, size, file_from_world, where);
    if (const auto* grid = handle.grid<nanovdb::FpN>())
        return densities(*grid, size, file_from_world, where);
    throw refusal(where, "the grid \"" + name +
                             "\" has values of another type; expected ones of single precision, or "
                             "quantised");
}

}  // namespace covtrace
