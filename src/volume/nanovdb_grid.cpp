#include "volume/nanovdb_grid.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <new>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>
#include <type_traits>
#include <vector>

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

/// Whether all nodes of a grid lie within its bytes and are no more than fit there: the library
/// follows the offsets of a file without looking at them, and many of them may lead to one node.
template <class Grid>
bool is_sound(const Grid& grid, size_t bytes) {
    const auto* begin = reinterpret_cast<const uint8_t*>(&grid);
    size_t left = bytes;
    const auto lies_within = [&](const void* node, size_t size) {
        const auto at = reinterpret_cast<uintptr_t>(node) - reinterpret_cast<uintptr_t>(begin);
        return at < bytes && size <= bytes - at &&
               reinterpret_cast<uintptr_t>(node) % NANOVDB_DATA_ALIGNMENT == 0;
    };
    const auto takes = [&](size_t size) {
        if (size > left) return false;
        left -= size;
        return true;
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
        if (!lies_within(upper, sizeof(*upper)) || !takes(sizeof(*upper))) return false;
        for (auto u = upper->beginChild(); u; ++u) {
            const auto& lower = *u;
            if (!lies_within(&lower, sizeof(lower)) || !takes(sizeof(lower))) return false;
            for (auto l = lower.beginChild(); l; ++l) {
                const auto& leaf = *l;
                if (!lies_within(&leaf, sizeof(leaf)) ||
                    !lies_within(&leaf, leaf.data()->memUsage()) || !takes(leaf.data()->memUsage()))
                    return false;
            }
        }
    }
    return true;
}

/// Walks through a file's parts before the library does, which goes wherever their sizes lead: back
/// to a part that was read, or beyond the end. Errors: std::runtime_error.
class FileCheck {
  public:
    explicit FileCheck(const std::string& bytes) : bytes_(bytes) {}
    void run() {
        nanovdb::io::Header header;
        while (left() >= sizeof(header)) {
            header = take<nanovdb::io::Header>();
            if (header.magic != NANOVDB_MAGIC_NUMBER) return;  // the library says so
            // Each version of the format goes on in another way behind the header
            if (const auto& v = header.version; v.getMajor() != NANOVDB_MAJOR_VERSION_NUMBER)
                throw std::runtime_error(
                    "it is of version " + std::to_string(v.getMajor()) + "." +
                    std::to_string(v.getMinor()) + "." + std::to_string(v.getPatch()) +
                    " of the format; expected " + std::to_string(NANOVDB_MAJOR_VERSION_NUMBER));
            std::vector<nanovdb::io::MetaData> grids;
            for (int i = 0; i < header.gridCount; ++i) {
                grids.push_back(take<nanovdb::io::MetaData>());
                skip(grids.back().nameSize);
                if (grids.back().nameSize == 0 || bytes_[at_ - 1] != '\0')
                    throw std::runtime_error("a grid's name has no end");
            }
            for (const nanovdb::io::MetaData& grid : grids) {
                const size_t begin = at_;
                check_grid(grid, header.codec);
                at_ = begin;
                skip(grid.fileSize);
            }
        }
    }

  private:
    size_t left() const { return bytes_.size() - at_; }
    void skip(uint64_t size) {
        if (size > left()) throw std::runtime_error("it ends too early");
        at_ += size;
    }
    template <class T>
    T take() {
        T value;
        const char* from = bytes_.data() + at_;
        skip(sizeof(T));
        std::memcpy(static_cast<void*>(&value), from, sizeof(T));
        return value;
    }
    void check_grid(const nanovdb::io::MetaData& grid, nanovdb::io::Codec codec) {
        if (codec == nanovdb::io::Codec::NONE) {
            skip(grid.gridSize);
        } else if (codec == nanovdb::io::Codec::ZIP) {
            skip(take<uint64_t>());
        } else if (codec == nanovdb::io::Codec::BLOSC) {
            // The decoder trusts the sizes in its data's own header
            for (uint64_t wanted = grid.gridSize; wanted > 0;) {
                const auto size = take<uint64_t>();
                const char* data = bytes_.data() + at_;
                skip(size);
                const uint64_t piece = std::min<uint64_t>(wanted, nanovdb::io::Internal::MAX_SIZE);
                size_t holds = 0;
                if (blosc_cbuffer_validate(data, size, &holds) != 0 || holds != piece)
                    throw std::runtime_error("its compressed values are damaged");
                wanted -= piece;
            }
        }
    }

    const std::string& bytes_;
    size_t at_ = 0;
};

/// Takes points of the file's world to the grid's lattice, whose places count from `first` on.
template <class Grid>
std::optional<Transform> lattice_from_file(const Grid& grid, const LatticePlace& first) {
    const auto image = [&](double x, double y, double z) {
        return grid.worldToIndex(nanovdb::Vec3d(x, y, z));
    };
    const auto origin = image(0, 0, 0);
    const std::array<nanovdb::Vec3d, 3> axes{image(1, 0, 0), image(0, 1, 0), image(0, 0, 1)};
    Matrix4 m;
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) m.m[size_t(r)][size_t(c)] = axes[size_t(c)][r] - origin[r];
        m.m[size_t(r)][3] = origin[r] - first[size_t(r)];
    }
    return Transform::from_matrix(m);
}

/// The cube of 128 places along each side that holds one.
LatticePlace cube_of(const nanovdb::Coord& c) {
    return {c[0] >> 7, c[1] >> 7, c[2] >> 7};
}

/// The cubes in which values may be above 0; empty where that is so in most of the space.
template <class Grid>
std::optional<std::set<LatticePlace>> filled_cubes(const Grid& grid) {
    const auto& root = grid.tree().root();
    if (float(root.background()) > 0) return std::nullopt;
    std::set<LatticePlace> cubes;
    for (uint32_t i = 0; i < root.data()->mTableSize; ++i) {
        const auto* tile = root.data()->tile(i);
        if (!tile->isChild()) {
            if (float(tile->value) > 0) return std::nullopt;
            continue;
        }
        const auto& upper = *root.data()->getChild(tile);
        using Upper = std::decay_t<decltype(upper)>;
        for (uint32_t n = 0; n < Upper::SIZE; ++n) {
            if (!upper.data()->mChildMask.isOn(n) && !(float(upper.data()->mTable[n].value) > 0))
                continue;
            const LatticePlace first = cube_of(tile->origin());
            const nanovdb::Coord at = Upper::OffsetToLocalCoord(n);
            cubes.insert({first[0] + at[0], first[1] + at[1], first[2] + at[2]});
        }
    }
    return cubes;
}

template <class Value>
std::shared_ptr<const DensityGrid> densities(const nanovdb::NanoGrid<Value>& grid, size_t bytes,
                                             const Transform& file_from_world,
                                             const SourceLocation& where) {
    if (!is_sound(grid, bytes)) throw refusal(where, "the file is damaged: a node lies outside");
    if (grid.activeVoxelCount() == 0) throw refusal(where, "the grid is empty");
    const nanovdb::CoordBBox box = grid.indexBBox();
    // Places count from a leaf's corner on: far from the lattice's origin single precision is
    // coarse
    constexpr int kFarthest = 1 << 28, kLeaf = 8;
    LatticePlace corner, last, first;
    for (int i = 0; i < 3; ++i) {
        const auto a = size_t(i);
        if (box.min()[i] < -kFarthest || box.max()[i] > kFarthest || box.min()[i] > box.max()[i])
            throw refusal(where, "the grid's bounds are out of range");
        corner[a] = box.min()[i] & -kLeaf;
        first[a] = box.min()[i] - corner[a];
        last[a] = box.max()[i] - corner[a];
    }
    const auto lattice_from_world = lattice_from_file(grid, corner);
    if (!lattice_from_world) throw refusal(where, "the grid's own transform is singular");
    const Bounds3 bounds{{float(first[0]), float(first[1]), float(first[2])},
                         {float(last[0] + 1), float(last[1] + 1), float(last[2] + 1)}};
    const auto accessor = grid.getAccessor();
    const auto coordinates = [&](const LatticePlace& p) {
        return nanovdb::Coord(p[0] + corner[0], p[1] + corner[1], p[2] + corner[2]);
    };
    const auto value = [&](const LatticePlace& p) {
        const float v = float(accessor.getValue(coordinates(p)));
        return v > 0 && v <= std::numeric_limits<float>::max() ? v : 0.0f;
    };
    // Values of places that share their numbers but for the last three bits are in one leaf, or all
    // the same. A box touches no more of such cubes, or of those of filled_cubes(), than one at
    // each of its corners.
    const auto filled = filled_cubes(grid);
    const auto is_empty = [&](const LatticePlace& from, const LatticePlace& to) {
        const bool is_block = to[0] - from[0] <= kLeaf;
        if (!is_block && !filled) return false;
        for (int i = 0; i < 8; ++i) {
            const LatticePlace p{(i & 1) ? to[0] : from[0], (i & 2) ? to[1] : from[1],
                                 (i & 4) ? to[2] : from[2]};
            const nanovdb::Coord c = coordinates(p);
            if (is_block ? accessor.probeLeaf(c) || value(p) > 0 : filled->contains(cube_of(c)))
                return false;
        }
        return true;
    };
    return std::make_shared<const DensityGrid>(*lattice_from_world * file_from_world, bounds,
                                               Lattice{first, last, value, is_empty}, where);
}

}  // namespace

std::shared_ptr<const DensityGrid> read_nanovdb(const std::string& bytes, const std::string& name,
                                                const Transform& file_from_world,
                                                const SourceLocation& where) {
    nanovdb::GridHandle<nanovdb::HostBuffer> handle;
    try {
        std::istringstream metadata(bytes), grids(bytes);
        FileCheck(bytes).run();
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
    // The library goes on to the next grid until it meets the first one
    const auto* header = reinterpret_cast<const nanovdb::GridData*>(handle.data());
    if (size < sizeof(*header) || header->mGridIndex != 0)
        throw refusal(where, "the file is damaged: it is not its first grid");
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
