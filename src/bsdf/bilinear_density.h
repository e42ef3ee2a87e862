/// Densities over the unit square that are bilinear between the nodes of a table, for several
/// tables at once.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/vec.h"

namespace covtrace {

/// Up to four tables and their weights, which sum to 1.
struct TableWeights {
    std::array<size_t, 4> table{};
    std::array<float, 4> weight{};
    int count = 0;
};

class BilinearDensity {
  public:
    /// `values` are tables of width x height nodes, at least 2 x 2, none below 0; each is scaled so
    /// that its integral is 1. A table of zeros stands for an even density.
    BilinearDensity(int width, int height, std::span<const float> values);

    struct Sample {
        Vec2 place;
        float pdf = 0;  ///< of the place among the density's samples
    };
    /// Maps the unit square to places by their density.
    Sample sample(Vec2 u, const TableWeights& weights) const;
    /// The point of the unit square that `sample` maps to a place; `pdf` is that of the place.
    Sample invert(Vec2 place, const TableWeights& weights) const;
    float pdf(Vec2 place, const TableWeights& weights) const;

  private:
    /// Sum over the tables of `values`, which are `size` apart.
    static float mix(const std::vector<float>& values, size_t size, size_t i,
                     const TableWeights& weights);
    /// The density at the corners of a cell.
    std::array<float, 4> corners(size_t x, size_t y, const TableWeights& weights) const;
    float along_row(size_t x, size_t y, const TableWeights& weights) const;
    float row_total(size_t y, const TableWeights& weights) const;

    size_t width_, height_;
    std::vector<float> nodes_;  // by cell: a cell's share is the mean of its corners
    std::vector<float> along_;  // integral along each row of nodes, up to each node
    std::vector<float> up_;     // integral over all rows of cells below each row of nodes
};

}  // namespace covtrace
