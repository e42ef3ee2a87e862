#include "reconstruction/window_sums.h"

#include <algorithm>

#include "core/parallel.h"

namespace covtrace {

namespace {

/// Every `stride`-th pixel of an image from (x0, y0) on.
struct Lattice {
    int x0, y0, stride;

    Plane pixels_of(const Plane& p) const {
        Plane some((p.width - x0 + stride - 1) / stride, (p.height - y0 + stride - 1) / stride);
        for (int y = 0; y < some.height; ++y)
            for (int x = 0; x < some.width; ++x) some(x, y) = p(x0 + x * stride, y0 + y * stride);
        return some;
    }
    std::vector<MarginPlane> pixels_of(std::span<const Plane> planes) const {
        std::vector<MarginPlane> some;
        some.reserve(planes.size());
        for (const Plane& p : planes) some.emplace_back(pixels_of(p));
        return some;
    }
};

/// The planes of one lattice, which no other one takes part in.
struct LatticePlanes {
    Lattice lattice;
    Likeness likeness;
    std::vector<MarginPlane> linear, squares;

    /// Sets the sums of the lattice's row y.
    void sum_row(int y, WindowSums& sums) const {
        const int row = lattice.y0 + y * lattice.stride, width = sums.linear[0].width;
        std::vector<float> sum(std::max(linear.size(), squares.size()));
        for (int x = 0; lattice.x0 + x * lattice.stride < width; ++x) {
            const int column = lattice.x0 + x * lattice.stride;
            Likeness::Window weights;
            likeness.weigh(x, y, weights);
            weighted_sums(linear, weights, x, y, sum.data());
            for (size_t k = 0; k < linear.size(); ++k) sums.linear[k](column, row) = sum[k];
            if (squares.empty()) continue;
            for (float& weight : weights) weight *= weight;
            weighted_sums(squares, weights, x, y, sum.data());
            for (size_t k = 0; k < squares.size(); ++k) sums.squares[k](column, row) = sum[k];
        }
    }
};

}  // namespace

WindowSums window_sums(std::span<const Plane> guides, std::span<const Plane> linear,
                       std::span<const Plane> squares, int stride,
                       const LikenessSettings& settings) {
    const int width = linear[0].width, height = linear[0].height;
    WindowSums sums{std::vector<Plane>(linear.size(), Plane(width, height)),
                    std::vector<Plane>(squares.size(), Plane(width, height))};
    const int columns = std::min(stride, width), most_rows = (height + stride - 1) / stride;
    // The lattices of one row at once, so that not all of their planes are in memory
    for (int y0 = 0; y0 < std::min(stride, height); ++y0) {
        std::vector<LatticePlanes> lattices;
        for (int x0 = 0; x0 < columns; ++x0) {
            const Lattice lattice{x0, y0, stride};
            lattices.push_back({lattice, Likeness(settings), lattice.pixels_of(linear),
                                lattice.pixels_of(squares)});
            for (const Plane& guide : guides)
                lattices.back().likeness.add(lattice.pixels_of(guide));
        }
        parallel_for_rows(width / columns, columns * most_rows, [&](int i) {
            const int y = i % most_rows;
            if (y0 + y * stride < height) lattices[size_t(i / most_rows)].sum_row(y, sums);
        });
    }
    return sums;
}

}  // namespace covtrace
