#include "reconstruction/patch_distance.h"

#include <algorithm>
#include <array>

#include "reconstruction/lanes.h"

namespace covtrace {

PaddedPlane::PaddedPlane(const Plane& plane, int width_of_border)
    : border(width_of_border),
      stride(plane.width + 2 * border + PatchDistance::kRow),
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

template <int Radius>
void PatchDistance::block_of(int x0, int y0, int dx, int dy, float* out) const {
    static_assert(Radius <= kLargestPatch && kRow % kLanes == 0 && kBlock % kLanes == 0);
    constexpr int kSide = kBlock + 2 * Radius;
    // Differences beyond this say "not alike" however much larger they are; without the limit one
    // of them would drown the rounding of the sums.
    constexpr float kMost = 1e4f;
    std::array<float, size_t(kSide) * kRow> d;
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kRow; x += int(kLanes)) {
            const int px = x0 - Radius + x, py = y0 - Radius + y;
            Lanes above{}, below{};
            for (size_t c = 0; c < values_.size(); ++c) {
                const Lanes v = load(variances_[c].at(px, py)),
                            v_q = load(variances_[c].at(px + dx, py + dy));
                const Lanes difference =
                    load(values_[c].at(px, py)) - load(values_[c].at(px + dx, py + dy));
                above += difference * difference - (v + smaller(v, v_q));
                below += v + v_q;
            }
            store(smaller(above / (1e-10f + below), kMost - Lanes{}),
                  &d[size_t(y) * kRow + size_t(x)]);
        }
    const float scale = 1 / float((2 * Radius + 1) * (2 * Radius + 1));
    for (int y = 0; y < kBlock; ++y) {
        std::array<float, kRow> column;
        for (int x = 0; x < kRow; x += int(kLanes)) {
            Lanes sum{};
            for (int k = 0; k <= 2 * Radius; ++k) sum += load(&d[size_t(y + k) * kRow + size_t(x)]);
            store(sum, &column[size_t(x)]);
        }
        for (int x = 0; x < kBlock; x += int(kLanes)) {
            Lanes sum{};
            for (int k = 0; k <= 2 * Radius; ++k) sum += load(&column[size_t(x + k)]);
            store(sum * scale, out + size_t(y) * kBlock + size_t(x));
        }
    }
}

void PatchDistance::block(int x0, int y0, int dx, int dy, float* out) const {
    patch_radius_ == 1 ? block_of<1>(x0, y0, dx, dy, out) : block_of<3>(x0, y0, dx, dy, out);
}

}  // namespace covtrace
