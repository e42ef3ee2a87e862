/// The scene's pixel filter, importance sampled: a sample belongs to one pixel and the filter
/// shapes its position, so that samples of different pixels stay independent (Ernst et al. 2006).
#pragma once

#include <array>
#include <cstdint>

#include "core/vec.h"
#include "scene/scene_description.h"

namespace covtrace {

class PixelFilter {
  public:
    explicit PixelFilter(const FilterDescription& description);

    struct Sample {
        Vec2 offset;       ///< from the pixel's centre, in pixels
        float weight = 1;  ///< 1 for filters without negative lobes; its expectation is 1
    };
    /// Maps `u` in [0, 1)^2 to an offset. The filter is separable, and so is the map.
    Sample sample(Vec2 u) const;
    /// Variance of the offset along x and y, in pixels^2 (signed weights included).
    Vec2 variance() const { return variance_; }

  private:
    /// One axis of the filter: a finely tabulated |f| and its distribution function.
    struct Axis {
        static constexpr int kCells = 1024;
        float radius = 0.5f;
        float weight = 1;  // integral of |f| over integral of f
        std::array<float, kCells + 1> cdf{};
        std::array<bool, kCells> negative{};
        /// The first cell that may hold u, for each u = k / kCells.
        std::array<uint16_t, kCells> first{};
        std::array<float, 2> sample(float u) const;  // offset, weight
    };
    Axis x_, y_;
    Vec2 variance_;
};

}  // namespace covtrace
