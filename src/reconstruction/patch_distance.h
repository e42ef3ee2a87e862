/// How unlike the neighbourhoods of two pixels are, in units of their noise.
#pragma once

#include <span>
#include <vector>

#include "core/plane.h"

namespace covtrace {

/// A plane with a border on all sides that repeats its outermost pixels (or holds `outside`), so
/// that windows need no bounds.
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
/// pixels that differ by noise.
class PatchDistance {
  public:
    /// The side of the blocks of pixels that are worked on at once.
    static constexpr int kBlock = 32;
    static constexpr int kLargestPatch = 3;
    /// Pixels of a row that are worked on for a block, patches included.
    static constexpr int kRow = (kBlock + 2 * kLargestPatch + 7) / 8 * 8;

    /// One plane, or three of one size. `reach`: largest offset along an axis;
    /// `patch_radius`: 1 or 3; of a block every `row_step`-th row is asked for.
    PatchDistance(std::span<const Plane> values, std::span<const Plane> variances, int reach,
                  int patch_radius, int row_step = 1);

    /// d(p, p + (dx, dy)) for the kBlock x kBlock pixels from (x0, y0), row by row, of which every
    /// row_step-th is set. Pixels outside the image get some value.
    void block(int x0, int y0, int dx, int dy, float* out) const;

  private:
    template <size_t Planes>
    void differences(int x0, int y0, int dx, int dy, float* out) const;

    std::vector<PaddedPlane> values_;
    PaddedPlane noise_;  // the sum of the variances
    int patch_radius_, row_step_;
};

/// 1 at d <= 0, falls as exp(-d), 0 from d = 4 on: (1 - d/4)^4. Numbers or Lanes.
template <typename T>
T patch_weight(const T& d) {
    const T clipped = d > 0.0f ? d : T{};
    const T t = clipped < 4.0f ? 1.0f - 0.25f * clipped : T{};
    const T square = t * t;
    return square * square;
}

}  // namespace covtrace
