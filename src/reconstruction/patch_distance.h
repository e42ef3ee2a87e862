/// Distances between the neighbourhoods of two pixels, in units of their noise.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "core/plane.h"

namespace covtrace {

/// A plane with a border on all sides that repeats its outermost pixels (or holds `outside`), so
/// that windows need no bounds. Each row has one vector more on its right, for loads that begin at
/// its last pixels.
struct PaddedPlane {
    PaddedPlane() = default;
    PaddedPlane(const Plane& plane, int border);
    PaddedPlane(const Plane& plane, int border, float outside);
    /// Pointer to pixel (x, y) of the plane; x and y may reach `border` beyond it.
    const float* at(int x, int y) const {
        return &values[size_t(y + border) * size_t(stride) + size_t(x + border)];
    }
    int border = 0, stride = 0;
    std::vector<float> values;
};

/// The squared distance of patches, less what noise alone explains (Rousselle, Knaus and Zwicker
/// 2012):  d(p, q) = mean over the patch of
///     (sum_c (u_p - u_q)^2 - (v_p + min(v_p, v_q))) / (v_p + v_q)
/// with u_p the values of the channels c and v_p the sum of their variances. About -1/2..0 for
/// pixels that differ by noise. Patches reach `Radius` pixels, of every `Step`-th pixel along rows
/// and columns of blocks of `Side` x `Side`: <3, 1, 32> and <1, 3, 48>, where none overlap.
template <int Radius, int Step, int Side>
class PatchDistance {
  public:
    static constexpr int kBlock = Side;
    /// Number of patches of a block along a row.
    static constexpr int kPatches = kBlock / Step;

    /// Prepares the comparison of one plane, or of three of one size. `reach`: largest offset along
    /// an axis.
    PatchDistance(std::span<const Plane> values, std::span<const Plane> variances, int reach);

    /// Number of pixels of the block from (x0, y0) that are in the image, along a row and along a
    /// column.
    int columns(int x0) const { return std::min(kBlock, width_ - x0); }
    int rows(int y0) const { return std::min(kBlock, height_ - y0); }

    /// Whether any p + (dx, dy) of the block is in the image.
    bool reaches(int x0, int y0, int dx, int dy) const {
        return x0 + dx < width_ && x0 + columns(x0) + dx > 0 && y0 + dy < height_ &&
               y0 + rows(y0) + dy > 0;
    }

    /// Sets out[k stride] to d(p, p + (dx, dy)) of the k-th patch, row by row, of the block from
    /// (x0, y0). Entries of pixels p outside the image get some value or stay as they were.
    void block(int x0, int y0, int dx, int dy, float* out, size_t stride = 1) const;

    /// Whether nothing has noise in the patches of a block and in those that it is compared with.
    bool is_without_noise(int x0, int y0) const;

  private:
    /// Number of pixels in a row, and of rows, that the block's patches cover; rows are rounded up
    /// to whole vectors.
    static constexpr int kCovered = kBlock - Step + 1 + 2 * Radius;
    static constexpr int kRow = (kCovered + 7) / 8 * 8;
    static_assert(kBlock % Step == 0 && kBlock % 8 == 0);

    /// Number of pixels that the patches of the first `size` pixels along an axis cover.
    static constexpr int covered(int size) { return (size - 1) / Step * Step + 1 + 2 * Radius; }

    template <size_t Planes>
    void differences(int x0, int y0, int dx, int dy, float* out) const;

    int reach_, width_, height_;
    std::vector<PaddedPlane> values_;
    PaddedPlane noise_;  // the sum of the variances
};

/// Weight of a patch at the distance d: 1 at d <= 0, falls as exp(-d), 0 from d = 4 on: (1 -
/// d/4)^4. T is a number or Float8.
template <typename T>
T patch_weight(const T& d) {
    const T clipped = d > 0.0f ? d : T{};
    const T t = clipped < 4.0f ? 1.0f - 0.25f * clipped : T{};
    const T square = t * t;
    return square * square;
}

}  // namespace covtrace
