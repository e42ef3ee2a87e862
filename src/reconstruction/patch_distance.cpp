#include "reconstruction/patch_distance.h"

#include <algorithm>
#include <array>

namespace covtrace {

PaddedPlane::PaddedPlane(const Plane& plane, int width_of_border)
    : border(width_of_border),
      stride(plane.width + 2 * border + PatchDistance::kBlock),
      values(size_t(stride) * size_t(plane.height + 2 * border + PatchDistance::kBlock)) {
    // Beyond the border one more block, so that the last block of a row may be a whole one.
    for (int y = -border; y < plane.height + border + PatchDistance::kBlock; ++y) {
        const float* source =
            &plane.values[size_t(std::clamp(y, 0, plane.height - 1)) * size_t(plane.width)];
        float* row = &values[size_t(y + border) * size_t(stride)];
        for (int x = 0; x < stride; ++x)
            row[x] = source[std::clamp(x - border, 0, plane.width - 1)];
    }
}

PaddedPlane::PaddedPlane(const Plane& plane, int width_of_border, float outside)
    : PaddedPlane(plane, width_of_border) {
    const int rows = int(values.size()) / stride;
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < stride; ++x)
            if (x < border || x >= border + plane.width || y < border || y >= border + plane.height)
                values[size_t(y) * size_t(stride) + size_t(x)] = outside;
}

PatchDistance::PatchDistance(std::span<const Plane> values, std::span<const Plane> variances,
                             int reach, int patch_radius)
    : patch_radius_(patch_radius) {
    const int border = reach + patch_radius + 1;
    for (const Plane& p : values) values_.emplace_back(p, border);
    for (const Plane& p : variances) variances_.emplace_back(p, border);
}

void PatchDistance::block(int x0, int y0, int dx, int dy, float* out) const {
    constexpr int kSide = kBlock + 2 * kLargestPatch;
    constexpr int kRow = (kSide + 7) / 8 * 8;
    // Differences beyond this say "not alike" however much larger they are; without the limit one
    // of them would drown the rounding of the sums.
    constexpr float kMost = 1e4f;
    const int r = patch_radius_, side = kBlock + 2 * r;
    std::array<float, size_t(kSide) * kRow> d;
    for (int y = 0; y < side; ++y) {
        std::array<float, kRow> above{}, below{};
        for (size_t c = 0; c < values_.size(); ++c) {
            const float* u = values_[c].at(x0 - r, y0 - r + y);
            const float* u_q = values_[c].at(x0 - r + dx, y0 - r + y + dy);
            const float* v = variances_[c].at(x0 - r, y0 - r + y);
            const float* v_q = variances_[c].at(x0 - r + dx, y0 - r + y + dy);
            for (int x = 0; x < side; ++x) {
                const float difference = u[x] - u_q[x];
                above[size_t(x)] +=
                    difference * difference - (v[x] + (v[x] < v_q[x] ? v[x] : v_q[x]));
                below[size_t(x)] += v[x] + v_q[x];
            }
        }
        float* row = &d[size_t(y) * kRow];
        for (int x = 0; x < side; ++x) {
            const float ratio = above[size_t(x)] / (1e-10f + below[size_t(x)]);
            row[x] = ratio < kMost ? ratio : kMost;
        }
    }
    const float scale = 1 / float((2 * r + 1) * (2 * r + 1));
    for (int y = 0; y < kBlock; ++y) {
        std::array<float, kRow> column{};
        for (int k = 0; k <= 2 * r; ++k) {
            const float* row = &d[size_t(y + k) * kRow];
            for (int x = 0; x < kRow; ++x) column[size_t(x)] += row[x];
        }
        float* target = out + size_t(y) * kBlock;
        for (int x = 0; x < kBlock; ++x) target[x] = column[size_t(x)];
        for (int k = 1; k <= 2 * r; ++k)
            for (int x = 0; x < kBlock; ++x) target[x] += column[size_t(x + k)];
        for (int x = 0; x < kBlock; ++x) target[x] *= scale;
    }
}

}  // namespace covtrace
