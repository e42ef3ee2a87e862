/// A raster of one float per cell with wrap rules, and the filters that a pyramid is made of.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

namespace covtrace {

struct ScalarField {
    int width = 0, height = 0;
    bool repeat_x = false, repeat_y = false;  ///< else the border's values continue outside
    std::vector<float> values;                ///< row by row

    ScalarField() = default;
    /// Zero-filled.
    ScalarField(int columns, int rows, bool repeats_x, bool repeats_y)
        : width(columns),
          height(rows),
          repeat_x(repeats_x),
          repeat_y(repeats_y),
          values(size_t(columns) * size_t(rows)) {}
    ScalarField like_this() const { return {width, height, repeat_x, repeat_y}; }

    float* row(int y) { return values.data() + size_t(y) * size_t(width); }
    const float* row(int y) const { return values.data() + size_t(y) * size_t(width); }
    int column_index(int x) const { return wrapped(x, width, repeat_x); }
    int row_index(int y) const { return wrapped(y, height, repeat_y); }
    size_t memory() const { return values.size() * sizeof(float); }

    static int wrapped(int i, int n, bool repeats) {
        if (i >= 0 && i < n) return i;
        if (!repeats) return i < 0 ? 0 : n - 1;
        return (i % n + n) % n;
    }
};

/// A Gaussian cut off at three standard deviations, normalised.
struct GaussianWindow {
    explicit GaussianWindow(float standard_deviation);
    int radius = 0;
    std::vector<float> weights;  ///< 2 radius + 1
    float variance = 0;          ///< of the window as it is, in cells^2
};

/// The weighted mean around each cell that has the window's radius of cells on all sides: a field
/// with twice the radius less in both directions.
ScalarField smooth_inside(const ScalarField& f, const GaussianWindow& window);
/// Every second cell in both directions after the binomial filter (1 3 3 1) / 8, whose variance is
/// 3/4 of a cell^2. Odd sizes are rounded up.
ScalarField halved(const ScalarField& f);
/// Where the bilinear interpolation of a halved field to the size it had reads on one axis: two
/// neighbouring cells and the second one's weight.
struct Between {
    int first = 0, second = 0;
    float weight = 0;
};
/// For the cell i of `size`, of which the halved field has `half_size`.
Between between(int i, int size, int half_size, bool repeats);
/// Means over boxes of factor^2 cells, cell(i) row by row; at the right and lower border over those
/// that exist.
ScalarField box_reduced(const std::function<float(size_t)>& cell, int columns, int rows,
                        bool repeats_x, bool repeats_y, int factor);

}  // namespace covtrace
