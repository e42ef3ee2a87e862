#include "volume/density_grid.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/memory_limit.h"

namespace covtrace {

namespace {

constexpr const char* kWhat = "a grid of densities";  // for errors

/// The way of a line through cells of a side of 1 or more, one after the other.
class CellWalk {
  public:
    /// Begins in the cell of [0, count) that holds o + t d.
    CellWalk(Vec3 o, Vec3 d, float t, float side, const LatticePlace& count)
        : o_(o), d_(d), side_(side) {
        for (int a = 0; a < 3; ++a) {
            // In this order neither is it a place that is no number
            const float place = std::floor((o[a] + t * d[a]) / side);
            cell_[size_t(a)] = int(std::max(0.0f, std::min(place, float(count[size_t(a)] - 1))));
            set_next(a);
        }
    }
    const LatticePlace& cell() const { return cell_; }
    /// Where the line leaves the cell.
    float leaves() const { return std::min({next_[0], next_[1], next_[2]}); }
    /// Goes to the next cell; false where that is outside of [0, count).
    bool advance(const LatticePlace& count) {
        const int axis =
            next_[0] <= next_[1] ? (next_[0] <= next_[2] ? 0 : 2) : (next_[1] <= next_[2] ? 1 : 2);
        cell_[size_t(axis)] += d_[axis] > 0 ? 1 : -1;
        set_next(axis);
        return cell_[size_t(axis)] >= 0 && cell_[size_t(axis)] < count[size_t(axis)];
    }

  private:
    void set_next(int axis) {
        const auto a = size_t(axis);
        if (d_[axis] == 0)
            next_[a] = kInfinity;
        else
            next_[a] = (float(cell_[a] + (d_[axis] > 0 ? 1 : 0)) * side_ - o_[axis]) / d_[axis];
    }

    Vec3 o_, d_;
    float side_;
    LatticePlace cell_{};
    std::array<float, 3> next_{};
};

/// The values at the corners of a cell, and what is between them.
struct Corners {
    std::array<float, 8> v;  // x changes fastest
    Corners(const float* first, size_t row, size_t slice)
        : v{first[0],     first[1],         first[row],         first[row + 1],
            first[slice], first[slice + 1], first[slice + row], first[slice + row + 1]} {}
    float at(Vec3 p) const {
        const auto mix = [](float a, float b, float t) { return a + t * (b - a); };
        return mix(mix(mix(v[0], v[1], p.x), mix(v[2], v[3], p.x), p.y),
                   mix(mix(v[4], v[5], p.x), mix(v[6], v[7], p.x), p.y), p.z);
    }
};

}  // namespace

/// A piece of a ray within a cell: places o + t d, in the cell's coordinates.
struct DensityGrid::Piece {
    Corners corners;
    Vec3 o, d;
    float begin, end;
    float at_begin, at_end;  ///< densities

    float density(float t) const { return std::max(0.0f, corners.at(o + t * d)); }
    /// The density's integral over the whole piece.
    float column() const {
        return (end - begin) / 6 * (at_begin + 4 * density(0.5f * (begin + end)) + at_end);
    }
    /// The density's integral from the beginning on.
    float column(float to) const {
        const float middle = 0.5f * (begin + to);
        return (to - begin) / 6 * (at_begin + 4 * density(middle) + density(to));
    }
    /// Where the integral reaches `wanted`, which is at most `whole`, that over the whole piece.
    float place(float wanted, float whole) const {
        float low = begin, high = end, t = begin;
        if (whole > 0) t += (end - begin) * std::min(1.0f, wanted / whole);
        for (int i = 0; i < 16; ++i) {
            const float error = column(t) - wanted;
            if (std::abs(error) <= 1e-6f * whole) break;
            (error < 0 ? low : high) = t;
            const float slope = density(t), newton = t - error / slope;
            t = slope > 0 && newton > low && newton < high ? newton : 0.5f * (low + high);
        }
        return t;
    }
};

DensityGrid::DensityGrid(const Transform& from_space, const Bounds3& bounds, const Lattice& lattice,
                         const SourceLocation& where)
    : bounds_(bounds) {
    for (size_t r = 0; r < 3; ++r)
        for (size_t c = 0; c < 4; ++c) {
            from_space_[r][c] = float(from_space.matrix().m[r][c]);
            if (!std::isfinite(from_space_[r][c]))
                throw Error(
                    ErrorKind::scene, where,
                    std::string(kWhat) + " has cells that are too small for single precision");
        }
    // Cells begin a place before the first value, since values outside of the box are 0
    constexpr double kMostBlocks = 1 << 28;
    double blocks = 1;
    for (size_t a = 0; a < 3; ++a) {
        origin_[a] = int(std::floor(double(lattice.first[a] - 1) / kCells)) * kCells;
        blocks_[a] = (lattice.last[a] - origin_[a]) / kCells + 1;
        blocks *= blocks_[a];
    }
    if (blocks > kMostBlocks)
        throw Error(ErrorKind::limit, where, std::string(kWhat) + " is too large");
    const MemoryReservation room(size_t(blocks) * sizeof(block_[0]), kWhat, where);
    block_.assign(size_t(blocks), kEmpty);
    fill(lattice, where);
}

void DensityGrid::fill(const Lattice& lattice, const SourceLocation& where) {
    constexpr int kTogether = 16;  // blocks along each side, looked at at once
    LatticePlace corner{}, block;
    for (corner[2] = 0; corner[2] < blocks_[2]; corner[2] += kTogether)
        for (corner[1] = 0; corner[1] < blocks_[1]; corner[1] += kTogether)
            for (corner[0] = 0; corner[0] < blocks_[0]; corner[0] += kTogether) {
                LatticePlace first, last, end;
                for (size_t a = 0; a < 3; ++a) {
                    first[a] = origin_[a] + kCells * corner[a];
                    last[a] = first[a] + kCells * kTogether;
                    end[a] = std::min(corner[a] + kTogether, blocks_[a]);
                }
                if (lattice.is_empty && lattice.is_empty(first, last)) continue;
                for (block[2] = corner[2]; block[2] < end[2]; ++block[2])
                    for (block[1] = corner[1]; block[1] < end[1]; ++block[1])
                        for (block[0] = corner[0]; block[0] < end[0]; ++block[0])
                            fill_block(block, lattice, where);
            }
    values_.shrink_to_fit();
}

void DensityGrid::fill_block(const LatticePlace& block, const Lattice& lattice,
                             const SourceLocation& where) {
    LatticePlace first, last;
    for (size_t a = 0; a < 3; ++a) {
        first[a] = origin_[a] + kCells * block[a];
        last[a] = first[a] + kCells;
    }
    if (lattice.is_empty && lattice.is_empty(first, last)) return;
    const auto inside = [&](const LatticePlace& p) {
        for (size_t a = 0; a < 3; ++a)
            if (p[a] < lattice.first[a] || p[a] > lattice.last[a]) return false;
        return true;
    };
    std::array<float, kBlockValues> values;
    float most = 0;
    float* value = values.data();
    LatticePlace p{};
    for (p[2] = first[2]; p[2] <= last[2]; ++p[2])
        for (p[1] = first[1]; p[1] <= last[1]; ++p[1])
            for (p[0] = first[0]; p[0] <= last[0]; ++p[0]) {
                *value = inside(p) ? std::max(0.0f, lattice.value(p)) : 0.0f;
                most = std::max(most, *value++);
            }
    if (!(most > 0)) return;
    if (values_.size() + kBlockValues > values_.capacity()) {
        const size_t larger = std::max<size_t>(64, 2 * values_.size() / kBlockValues);
        const MemoryReservation room(larger * kBlockValues * sizeof(float), kWhat, where);
        values_.reserve(larger * kBlockValues);
    }
    block_[index(block)] = int32_t(values_.size() / kBlockValues);
    values_.insert(values_.end(), values.begin(), values.end());
    largest_ = std::max(largest_, most);
}

size_t DensityGrid::bytes() const {
    return block_.capacity() * sizeof(block_[0]) + values_.capacity() * sizeof(values_[0]);
}

template <class Visit>
bool DensityGrid::walk_block(Vec3 o, Vec3 d, float begin, float end, const LatticePlace& block,
                             const float* values, const Visit& visit) const {
    constexpr LatticePlace kCount{kCells, kCells, kCells};
    constexpr size_t kRow = kPlaces, kSlice = size_t(kPlaces) * kPlaces;
    for (int a = 0; a < 3; ++a) o[a] -= float(kCells * block[size_t(a)]);
    CellWalk cells(o, d, begin, 1, kCount);
    float density = -1;  // at the beginning, where it is known from the cell before
    for (bool inside = true; inside && begin < end; inside = cells.advance(kCount)) {
        const float to = std::min(end, cells.leaves());
        if (!(to > begin)) continue;
        const LatticePlace& c = cells.cell();
        const Vec3 corner{float(c[0]), float(c[1]), float(c[2])};
        const float* first = values + size_t(c[0]) + kRow * size_t(c[1]) + kSlice * size_t(c[2]);
        Piece piece{Corners(first, kRow, kSlice), o - corner, d, begin, to, density, 0};
        if (density < 0) piece.at_begin = piece.density(begin);
        density = piece.at_end = piece.density(to);
        if (!visit(piece)) return false;
        begin = to;
    }
    return true;
}

template <class Visit>
void DensityGrid::walk(Vec3 origin, Vec3 direction, float length, const Visit& visit) const {
    Vec3 o, d;
    for (int r = 0; r < 3; ++r) {
        const auto& row = from_space_[size_t(r)];
        o[r] = row[0] * origin.x + row[1] * origin.y + row[2] * origin.z + row[3];
        d[r] = row[0] * direction.x + row[1] * direction.y + row[2] * direction.z;
    }
    // Clip the ray to the bounds and to the blocks
    float begin = 0, end = length;
    for (int a = 0; a < 3; ++a) {
        const float lo = std::max(bounds_.lo[a], float(origin_[size_t(a)])),
                    hi = std::min(bounds_.hi[a],
                                  float(origin_[size_t(a)] + kCells * blocks_[size_t(a)]));
        if (d[a] == 0) {
            if (!(o[a] >= lo && o[a] <= hi)) return;
            continue;
        }
        const float t0 = (lo - o[a]) / d[a], t1 = (hi - o[a]) / d[a];
        begin = std::max(begin, std::min(t0, t1));
        end = std::min(end, std::max(t0, t1));
    }
    if (!(begin < end && std::isfinite(end))) return;
    for (int a = 0; a < 3; ++a) o[a] -= float(origin_[size_t(a)]);
    CellWalk blocks(o, d, begin, kCells, blocks_);
    for (bool inside = true; inside && begin < end; inside = blocks.advance(blocks_)) {
        const float to = std::min(end, blocks.leaves());
        if (!(to > begin)) continue;
        const int32_t number = block_[index(blocks.cell())];
        if (number != kEmpty && !walk_block(o, d, begin, to, blocks.cell(),
                                            values_.data() + kBlockValues * size_t(number), visit))
            return;
        begin = to;
    }
}

float DensityGrid::at(Vec3 point) const {
    Vec3 p;
    for (int r = 0; r < 3; ++r) {
        const auto& row = from_space_[size_t(r)];
        p[r] = row[0] * point.x + row[1] * point.y + row[2] * point.z + row[3];
    }
    if (!bounds_.contains(p)) return 0;
    LatticePlace block;
    Vec3 within;
    for (int a = 0; a < 3; ++a) {
        const float from_first = p[a] - float(origin_[size_t(a)]);
        if (!(from_first >= 0 && from_first <= float(kCells * blocks_[size_t(a)]))) return 0;
        block[size_t(a)] = std::min(int(from_first) / kCells, blocks_[size_t(a)] - 1);
        within[a] = from_first - float(kCells * block[size_t(a)]);
    }
    const int32_t number = block_[index(block)];
    if (number == kEmpty) return 0;
    size_t first = kBlockValues * size_t(number), stride = 1;
    for (int a = 0; a < 3; ++a) {
        const int cell = std::min(int(within[a]), kCells - 1);
        within[a] -= float(cell);
        first += size_t(cell) * stride;
        stride *= kPlaces;
    }
    return Corners(values_.data() + first, kPlaces, size_t(kPlaces) * kPlaces).at(within);
}

float DensityGrid::column(Vec3 origin, Vec3 direction, float length, float most) const {
    double sum = 0;
    walk(origin, direction, length, [&](const Piece& piece) {
        sum += double(piece.column());
        return !(sum > double(most));
    });
    return float(sum);
}

void DensityGrid::distances(Vec3 origin, Vec3 direction, float length, const float* columns,
                            float* found, size_t count) const {
    size_t next = 0;
    double sum = 0;
    walk(origin, direction, length, [&](const Piece& piece) {
        const float whole = piece.column();
        const double after = sum + double(whole);
        for (; next < count && double(columns[next]) < after; ++next)
            found[next] = piece.place(float(double(columns[next]) - sum), whole);
        sum = after;
        return next < count;
    });
    std::fill(found + next, found + count, kInfinity);
}

}  // namespace covtrace
