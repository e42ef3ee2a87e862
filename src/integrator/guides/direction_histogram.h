/// A density over the unit square that is learnt from weighted points.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "core/hash.h"
#include "core/vec.h"

namespace covtrace {

/// A point of the unit square, drawn with some density, and what was found there.
struct SquarePoint {
    Vec2 place;
    float energy = 0;  ///< square of what was found, over the density
};

/// A histogram of 8x8 bins, as small as caches like it, sampled by halving the square along x and y
/// in turn: neighbours among numbers stay neighbours among places.
class DirectionHistogram {
  public:
    /// Makes an even density.
    DirectionHistogram();
    /// Follows the root of the mean square of what was found, which gives the least variance; parts
    /// that few points tell of are even. `points` are reordered.
    explicit DirectionHistogram(std::span<SquarePoint> points);

    /// A place of density `density`; `u` is in [0, 1)^2.
    Vec2 sample(Vec2 u) const {
        uint32_t node = 1, x = 0, y = 0;
        for (int level = 0; level < kLevels; level += 2) {
            x = 2 * x + halve(node, u.x);
            y = 2 * y + halve(node, u.y);
        }
        return {(static_cast<float>(x) + u.x) / kSide, (static_cast<float>(y) + u.y) / kSide};
    }
    /// Density at a place of [0, 1)^2, per area.
    float density(Vec2 place) const {
        const auto x = static_cast<uint32_t>(place.x * kSide);
        const auto y = static_cast<uint32_t>(place.y * kSide);
        return density_[y * kSide + x];
    }

  private:
    static constexpr int kLevels = 6;
    static constexpr uint32_t kSide = 1u << (kLevels / 2);

    /// Goes on to the half of a node that a number falls into, whose place there becomes the
    /// number.
    uint32_t halve(uint32_t& node, float& u) const {
        const float first = first_[node];
        const bool second = u >= first;
        u = std::min((second ? u - first : u) / (second ? 1 - first : first), kLargestBelowOne);
        node = 2 * node + (second ? 1 : 0);
        return second ? 1 : 0;
    }
    float build(std::span<SquarePoint> points, uint32_t node, int level, Vec2 low);
    void spread(uint32_t node, int level, uint32_t x, uint32_t y, float density);

    std::array<float, kSide * kSide> first_;    ///< of node n, probability of its half 2n
    std::array<float, kSide * kSide> density_;  ///< by rows
};

}  // namespace covtrace
