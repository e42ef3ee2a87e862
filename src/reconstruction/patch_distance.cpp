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
                             int reach, int patch_radius, int row_step)
    : patch_radius_(patch_radius), row_step_(row_step) {
    const int border = reach + patch_radius + 1;
    Plane noise(values[0].width, values[0].height);
    for (const Plane& p : values) values_.emplace_back(p, border);
    for (const Plane& p : variances)
        for (size_t i = 0; i < noise.size(); ++i) noise[i] += p[i];
    noise_ = PaddedPlane(noise, border);
}

/// The distances of the single pixels of a block and of what its patches reach, kRow in a row.
template <size_t Planes>
void PatchDistance::differences(int x0, int y0, int dx, int dy, float* out) const {
    // Differences beyond this say "not alike" however much larger they are; without the limit one
    // of them would drown the rounding of the sums.
    constexpr float kMost = 1e4f;
    const int rows = kBlock + 2 * patch_radius_, px = x0 - patch_radius_;
    for (int y = 0; y < rows; ++y, out += kRow) {
        const int py = y0 - patch_radius_ + y;
        std::array<const float*, Planes> u_p, u_q;
        for (size_t c = 0; c < Planes; ++c) {
            u_p[c] = values_[c].at(px, py);
            u_q[c] = values_[c].at(px + dx, py + dy);
        }
        const float *n_p = noise_.at(px, py), *n_q = noise_.at(px + dx, py + dy);
        for (int x = 0; x < kRow; x += int(kLanes)) {
            const Lanes noise = load(n_p + x), other = load(n_q + x);
            Lanes above = -noise - smaller(noise, other);
            for (size_t c = 0; c < Planes; ++c) {
                const Lanes difference = load(u_p[c] + x) - load(u_q[c] + x);
                above = multiply_add(difference, difference, above);
            }
            const Lanes below = 1e-10f + noise + other;
            store(smaller(above / below, kMost - Lanes{}), out + x);
        }
    }
}

namespace {

/// Means over the patches around the pixels of a block, of every `row_step`-th row.
template <int Radius>
void average_patches(const float* d, int row_step, float* out) {
    constexpr int kBlock = PatchDistance::kBlock, kRow = PatchDistance::kRow;
    constexpr int kPatch = 2 * Radius + 1;
    static_assert(Radius <= PatchDistance::kLargestPatch && kRow % kLanes == 0 &&
                  kBlock % kLanes == 0);
    const float scale = 1 / float(kPatch * kPatch);
    for (int y = 0; y < kBlock; y += row_step) {
        std::array<float, kRow> column;
        for (int x = 0; x < kRow; x += int(kLanes)) {
            Lanes sum{};
            for (int k = 0; k < kPatch; ++k) sum += load(d + (y + k) * kRow + x);
            store(sum, &column[size_t(x)]);
        }
        for (int x = 0; x < kBlock; x += int(kLanes)) {
            Lanes sum{};
            for (int k = 0; k < kPatch; ++k) sum += load(&column[size_t(x + k)]);
            store(sum * scale, out + y * kBlock + x);
        }
    }
}

}  // namespace

void PatchDistance::block(int x0, int y0, int dx, int dy, float* out) const {
    std::array<float, size_t(kBlock + 2 * kLargestPatch) * kRow> d;
    values_.size() == 1 ? differences<1>(x0, y0, dx, dy, d.data())
                        : differences<3>(x0, y0, dx, dy, d.data());
    patch_radius_ == 1 ? average_patches<1>(d.data(), row_step_, out)
                       : average_patches<kLargestPatch>(d.data(), row_step_, out);
}

}  // namespace covtrace
