/// Densities that vary over space: values of a lattice, linear between them.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/error.h"
#include "core/transform.h"
#include "core/vec.h"

namespace covtrace {

/// A place of a lattice, by whole numbers.
using LatticePlace = std::array<int, 3>;

/// The values of a lattice within a box; all others are 0.
struct Lattice {
    LatticePlace first, last;  ///< of the box, both within it
    std::function<float(LatticePlace)> value;
    /// Whether all values of the places from `first` to `last` are 0, where that is known without
    /// looking at each: of large boxes that are mostly empty. They reach over 8 or 128 cells along
    /// each side. May be empty.
    std::function<bool(LatticePlace first, LatticePlace last)> is_empty = {};
};

/// A density over space, not negative: trilinear between the values of a lattice, 0 outside of its
/// bounds. Integrals along rays are exact but for roundings: within a cell of the lattice the
/// density is a polynomial of third degree along any line, whose integral is Simpson's rule
/// (docs/decisions/0151). Blocks of 8 cells along each side that are empty take no memory and are
/// passed at once.
class DensityGrid {
  public:
    /// `from_space` takes points to the lattice's coordinates; `bounds` are in these. Values below
    /// 0 count as 0. Errors, at `where`: Error(limit) where the process may not hold them,
    /// Error(scene) for transforms whose numbers are out of single precision's range.
    DensityGrid(const Transform& from_space, const Bounds3& bounds, const Lattice& lattice,
                const SourceLocation& where = {});

    /// The density at a point.
    float at(Vec3 point) const;
    /// The integral of the density along a ray, over `length`, which may be infinite; no further
    /// than to where it exceeds `most`.
    float column(Vec3 origin, Vec3 direction, float length, float most = kInfinity) const;
    /// The distances at which the integral along a ray reaches columns, which rise; infinite from
    /// the first one on that it does not reach within `length`.
    void distances(Vec3 origin, Vec3 direction, float length, const float* columns, float* found,
                   size_t count) const;
    float distance(Vec3 origin, Vec3 direction, float length, float column) const {
        float found;
        distances(origin, direction, length, &column, &found, 1);
        return found;
    }
    float largest() const { return largest_; }
    size_t bytes() const;

  private:
    struct Piece;
    static constexpr int kCells = 8, kPlaces = kCells + 1;  // of a block along each side
    static constexpr size_t kBlockValues = size_t(kPlaces) * kPlaces * kPlaces;
    static constexpr int32_t kEmpty = -1;

    void fill(const Lattice& lattice, const SourceLocation& where);
    void fill_block(const LatticePlace& block, const Lattice& lattice, const SourceLocation& where);
    /// Calls visit(piece) for every piece of a ray within a cell of blocks that are not empty,
    /// until it returns false.
    template <class Visit>
    void walk(Vec3 origin, Vec3 direction, float length, const Visit& visit) const;
    template <class Visit>
    bool walk_block(Vec3 o, Vec3 d, float begin, float end, const LatticePlace& block,
                    const float* values, const Visit& visit) const;
    size_t index(const LatticePlace& block) const {
        return size_t(block[0]) +
               size_t(blocks_[0]) * (size_t(block[1]) + size_t(blocks_[1]) * size_t(block[2]));
    }

    std::array<std::array<float, 4>, 3> from_space_;  ///< rows of the affine map to the lattice
    Bounds3 bounds_;                                  ///< in the lattice's coordinates
    LatticePlace origin_;                             ///< of the first block
    LatticePlace blocks_;                             ///< along each side
    std::vector<int32_t> block_;                      ///< number of its values, or kEmpty
    std::vector<float> values_;                       ///< kBlockValues of each, x changes fastest
    float largest_ = 0;
};

}  // namespace covtrace
