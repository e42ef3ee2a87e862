/// Estimates of an image's bandwidth from Gaussian windows at one level of its pyramid and at all
/// coarser ones (see image_spectrum.h for the formula), in tiles that are made when they are first
/// asked for.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <vector>

#include "texture/scalar_field.h"
#include "texture/spatial_covariance.h"

namespace covtrace {

/// Estimate for one cell: the variance in the last window, and the estimate with the largest trace
/// among all windows so far, in cycles^2 per texel^2.
struct WindowEstimate {
    float variance = 0;
    SpatialCovariance2 largest;
};

/// A rectangle of cells; ends are exclusive.
struct CellRect {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    int width() const { return x1 - x0; }
    int height() const { return y1 - y0; }
};

class WindowEstimates {
  public:
    static constexpr int kTile = 64;  ///< cells

    /// `value`: the level about the image's mean `image_mean`, outlives this; `square`: of the same
    /// size, means of its squares, or empty where these are the squares of the means. A cell is
    /// `spacing` texels; `windows`: standard deviations in cells, from the widest on. `coarser`:
    /// the level of half the size, outlives this, or null.
    WindowEstimates(const ScalarField& value, ScalarField square, float spacing, float image_mean,
                    std::vector<float> windows, const WindowEstimates* coarser);

    /// Estimates of all cells of `rect`, row by row. Thread-safe; makes the tiles of the coarser
    /// levels that these cells are within, whose estimates are kept.
    std::vector<WindowEstimate> of(CellRect rect) const;

    /// Bytes; not while others ask.
    size_t memory() const;

  private:
    std::vector<WindowEstimate> doubled_coarser(CellRect rect) const;
    void need_tile(int tile_x, int tile_y) const;
    void make_tile(int tile_x, int tile_y) const;

    const ScalarField& value_;
    ScalarField square_;
    float spacing_, image_mean_;
    std::vector<float> windows_;
    const WindowEstimates* coarser_;

    int tiles_x_;
    std::unique_ptr<std::once_flag[]> made_;
    mutable std::atomic<size_t> cells_made_{0};
    std::unique_ptr<WindowEstimate[]> cells_;  ///< touched only where tiles are made
};

}  // namespace covtrace
