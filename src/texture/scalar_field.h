/// A raster of one float per cell with wrap rules, and the filters that a pyramid is made of.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

namespace covtrace {

struct ScalarField {
    int width = 0, height = 0;
    /// Whether cells repeat beyond the borders; else the border's values continue there.
    bool repeat_x = false, repeat_y = false;
    std::vector<float> values;  ///< row by row

    ScalarField() = default;
    /// Makes a field of zeros.
    ScalarField(int columns, int rows, bool repeats_x, bool repeats_y)
        : width(columns),
          height(rows),
          repeat_x(repeats_x),
          repeat_y(repeats_y),
          values(size_t(columns) * size_t(rows)) {}
    /// A field of zeros with the size and the wrap rules of this one.
    ScalarField like_this() const { return {width, height, repeat_x, repeat_y}; }

    float* row(int y) { return values.data() + size_t(y) * size_t(width); }
    const float* row(int y) const { return values.data() + size_t(y) * size_t(width); }
    int column_index(int x) const { return wrapped(x, width, repeat_x); }
    int row_index(int y) const { return wrapped(y, height, repeat_y); }
    size_t memory() const { return values.size() * sizeof(float); }

    /// Cell that stands for cell `i`, which may lie outside, of an axis with `n` cells.
    static int wrapped(int i, int n, bool repeats) {
        if (i >= 0 && i < n) return i;
        if (!repeats) return i < 0 ? 0 : n - 1;
        return (i % n + n) % n;
    }
};

/// Weights of a Gaussian window, cut off at three standard deviations (rounded up to whole cells)
/// and normalised to a sum of 1.
struct GaussianWindow {
    explicit GaussianWindow(float standard_deviation);
    int radius = 0;
    std::vector<float> weights;  ///< 2 radius + 1 of them, the middle one the largest
    float variance = 0;          ///< variance of the window after the cut, in cells^2
};

/// Means weighted by the window, around each cell that has the window's radius of cells on all
/// sides: the field becomes smaller by twice the radius in both directions.
ScalarField smooth_inside(const ScalarField& f, const GaussianWindow& window);
/// The field at half the resolution: cell x is the mean of cells 2x - 1 to 2x + 2 by the binomial
/// filter (1 3 3 1) / 8, whose variance is 3/4 of a cell^2. Odd sizes are rounded up.
ScalarField halved(const ScalarField& f);
/// Interpolation on one axis of a halved field back to its former size: the two neighbouring cells
/// to read, and the second one's weight.
struct Between {
    int first = 0, second = 0;
    float weight = 0;
};
/// The taps for cell `i` of an axis with `size` cells, `half_size` in the halved field.
Between between(int i, int size, int half_size, bool repeats);
/// Means over boxes of `factor` x `factor` cells, whose values `cell(i)` gives row by row; boxes at
/// the right and lower border may have fewer cells.
ScalarField box_reduced(const std::function<float(size_t)>& cell, int columns, int rows,
                        bool repeats_x, bool repeats_y, int factor);

}  // namespace covtrace
