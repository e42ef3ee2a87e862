#include "core/plane.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace covtrace {

namespace {

/// Values that a blur takes for pixels beyond the image's border.
enum class Border {
    repeat,  ///< the outermost pixels
    none,    ///< nothing: the taps inside are scaled to a sum of 1
    black
};

/// Convolves with `taps` along both axes: out(x, y) = sum over k of taps[k] in(x + k - reach, y),
/// then likewise along y.
Plane separable(const Plane& in, const std::vector<float>& taps, Border border) {
    const bool replicate = border == Border::repeat;
    const int reach = int(taps.size()) / 2, w = in.width, h = in.height;
    Plane rows(w, h), out(w, h);
    const auto row_of = [w](auto& plane, int y) { return &plane.values[size_t(y) * size_t(w)]; };
    // Sum of the taps that fall inside the image, around the place `at` on an axis.
    const auto inside = [&](int at, int size) {
        float sum = 0;
        for (int k = -reach; k <= reach; ++k)
            if (at + k >= 0 && at + k < size) sum += taps[size_t(k + reach)];
        return sum;
    };
    std::vector<float> inside_row(size_t(w), 1.0f);
    for (int x = 0; x < w; ++x)
        if (x < reach || x >= w - reach) inside_row[size_t(x)] = inside(x, w);
    parallel_for_row_ranges(w, h, [&](int first, int end) {
        std::vector<float> padded(size_t(w + 2 * reach), 0.0f);
        for (int y = first; y < end; ++y) {
            const float* source = row_of(in, y);
            std::copy(source, source + w, padded.begin() + reach);
            if (replicate) {
                std::fill(padded.begin(), padded.begin() + reach, source[0]);
                std::fill(padded.end() - reach, padded.end(), source[w - 1]);
            }
            float* target = row_of(rows, y);
            for (size_t k = 0; k < taps.size(); ++k)
                for (int x = 0; x < w; ++x) target[x] += taps[k] * padded[size_t(x) + k];
            if (border != Border::none) continue;
            for (int x = 0; x < w; ++x) target[x] /= inside_row[size_t(x)];
        }
    });
    parallel_for_rows(w, h, [&](int y) {
        float* target = row_of(out, y);
        for (int k = -reach; k <= reach; ++k) {
            int from = y + k;
            if (from < 0 || from >= h) {
                if (!replicate) continue;
                from = std::clamp(from, 0, h - 1);
            }
            const float tap = taps[size_t(k + reach)];
            const float* source = row_of(rows, from);
            for (int x = 0; x < w; ++x) target[x] += tap * source[x];
        }
        if (border != Border::none || (y >= reach && y < h - reach)) return;
        const float scale = 1 / inside(y, h);
        for (int x = 0; x < w; ++x) target[x] *= scale;
    });
    return out;
}

std::vector<float> gaussian_taps(float sigma) {
    const int reach = std::max(1, int(std::ceil(3 * sigma)));
    std::vector<float> taps(size_t(2 * reach + 1));
    float sum = 0;
    for (int k = -reach; k <= reach; ++k)
        sum += taps[size_t(k + reach)] = std::exp(-0.5f * float(k * k) / (sigma * sigma));
    for (float& t : taps) t /= sum;
    return taps;
}

}  // namespace

Plane box_blur(const Plane& plane, int radius) {
    const size_t n = size_t(2 * radius + 1);
    return separable(plane, std::vector<float>(n, 1 / float(n)), Border::repeat);
}

Plane gaussian_blur(const Plane& plane, float sigma) {
    return separable(plane, gaussian_taps(sigma), Border::none);
}

Plane gaussian_sum(const Plane& plane, float sigma) {
    return separable(plane, gaussian_taps(sigma), Border::black);
}

}  // namespace covtrace
