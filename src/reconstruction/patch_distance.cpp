#include "reconstruction/patch_distance.h"

#include <array>

#include "core/simd.h"

namespace covtrace {

PaddedPlane::PaddedPlane(const Plane& plane, int width_of_border)
    : border(width_of_border),
      stride(plane.width + 2 * border + int(kLanes)),
      values(size_t(stride) * size_t(plane.height + 2 * border)) {
    for (int y = -border; y < plane.height + border; ++y) {
        const float* source =
            &plane.values[size_t(std::clamp(y, 0, plane.height - 1)) * size_t(plane.width)];
        float* row = &values[size_t(y + border) * size_t(stride)];
        std::fill_n(row, border, source[0]);
        std::copy_n(source, plane.width, row + border);
        std::fill(row + border + plane.width, row + stride, source[plane.width - 1]);
    }
}

PaddedPlane::PaddedPlane(const Plane& plane, int width_of_border, float outside)
    : PaddedPlane(plane, width_of_border) {
    for (int y = -border; y < plane.height + border; ++y) {
        float* row = &values[size_t(y + border) * size_t(stride)];
        const bool inside = y >= 0 && y < plane.height;
        std::fill_n(row, inside ? border : stride, outside);
        if (inside) std::fill(row + border + plane.width, row + stride, outside);
    }
}

template <int Radius, int Step, int Side>
PatchDistance<Radius, Step, Side>::PatchDistance(std::span<const Plane> values,
                                                 std::span<const Plane> variances, int reach)
    : reach_(reach), width_(values[0].width), height_(values[0].height) {
    const int border = reach + Radius + 1;
    Plane noise(values[0].width, values[0].height);
    for (const Plane& p : values) values_.emplace_back(p, border);
    for (const Plane& p : variances)
        for (size_t i = 0; i < noise.size(); ++i) noise[i] += p[i];
    noise_ = PaddedPlane(noise, border);
}

/// Writes the distances of single pixels, kRow in a row, for the pixels that the patches of a block
/// cover whose centres are in the image.
template <int Radius, int Step, int Side>
template <size_t Planes>
void PatchDistance<Radius, Step, Side>::differences(int x0, int y0, int dx, int dy,
                                                    float* out) const {
    // Largest difference that counts: beyond it pixels are not alike, however much larger it is;
    // without the limit one large difference would drown the rounding of the sums.
    constexpr float kMost = 1e4f;
    const int px = x0 - Radius, end_x = covered(columns(x0)), end_y = covered(rows(y0));
    for (int y = 0; y < end_y; ++y, out += kRow) {
        const int py = y0 - Radius + y;
        std::array<const float*, Planes> u_p, u_q;
        for (size_t c = 0; c < Planes; ++c) {
            u_p[c] = values_[c].at(px, py);
            u_q[c] = values_[c].at(px + dx, py + dy);
        }
        const float *n_p = noise_.at(px, py), *n_q = noise_.at(px + dx, py + dy);
        for (int x = 0; x < end_x; x += int(kLanes)) {
            const Float8 noise = load8(n_p + x), other = load8(n_q + x);
            Float8 above = -noise - min8(noise, other);
            for (size_t c = 0; c < Planes; ++c) {
                const Float8 difference = load8(u_p[c] + x) - load8(u_q[c] + x);
                above = multiply_add(difference, difference, above);
            }
            const Float8 below = 1e-10f + noise + other;
            store8(min8(above / below, kMost - Float8{}), out + x);
        }
    }
}

template <int Radius, int Step, int Side>
void PatchDistance<Radius, Step, Side>::block(int x0, int y0, int dx, int dy, float* out,
                                              size_t stride) const {
    std::array<float, size_t(kCovered) * kRow> d;
    values_.size() == 1 ? differences<1>(x0, y0, dx, dy, d.data())
                        : differences<3>(x0, y0, dx, dy, d.data());
    constexpr int kSide = 2 * Radius + 1;
    constexpr float kScale = 1 / float(kSide * kSide);
    // The row of sums is longer than it looks: vectors of the last means reach beyond it.
    std::array<float, size_t(kRow) + kLanes> column{};
    std::array<float, kBlock> mean;
    const int width = columns(x0), height = rows(y0), end = covered(width);
    for (int y = 0; y < height; y += Step) {
        for (int x = 0; x < end; x += int(kLanes)) {
            Float8 sum{};
            for (int k = 0; k < kSide; ++k) sum += load8(&d[size_t(y + k) * kRow + size_t(x)]);
            store8(sum, &column[size_t(x)]);
        }
        for (int x = 0; x < width; x += int(kLanes)) {
            Float8 sum{};
            for (int k = 0; k < kSide; ++k) sum += load8(&column[size_t(x + k)]);
            store8(sum * kScale, &mean[size_t(x)]);
        }
        float* row = out + size_t(y / Step) * kPatches * stride;
        for (int x = 0; x < width; x += Step, row += stride) *row = mean[size_t(x)];
    }
}

template <int Radius, int Step, int Side>
bool PatchDistance<Radius, Step, Side>::is_without_noise(int x0, int y0) const {
    const int margin = reach_ + Radius, end_y = std::min(y0 + kBlock, height_) + margin;
    for (int y = y0 - margin; y < end_y; ++y) {
        const float* row = noise_.at(x0 - margin, y);
        if (std::any_of(row, row + columns(x0) + 2 * margin, [](float v) { return v != 0; }))
            return false;
    }
    return true;
}

template class PatchDistance<3, 1, 32>;
template class PatchDistance<1, 3, 48>;

}  // namespace covtrace
