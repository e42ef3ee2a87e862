#include "reconstruction/bilateral.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "core/vec.h"

namespace covtrace {

void bilateral_blur(std::span<Plane* const> planes, const Plane& weight, const Plane& guide,
                    float sigma, float reach) {
    const int w = guide.width, h = guide.height, radius = int(2 * sigma);
    std::vector<float> gaussian;
    for (int d = 0; d <= radius; ++d) gaussian.push_back(std::exp(-sqr(float(d) / sigma) / 2));
    const float narrow = 1 / sqr(reach);
    const auto row_of = [w](const Plane& plane, int y) {
        return plane.values.data() + ptrdiff_t(y) * w;
    };
    std::vector<Plane> result(planes.size(), Plane(w, h));
    parallel_for_rows(w, h, [&](int y) {
        std::vector<float> kernel(size_t(w), 0.0f), total(size_t(w), 0.0f);
        const float* const own = row_of(guide, y);
        for (int v = std::max(0, y - radius); v <= std::min(h - 1, y + radius); ++v)
            for (int dx = -radius; dx <= radius; ++dx) {
                const float near =
                    gaussian[size_t(std::abs(v - y))] * gaussian[size_t(std::abs(dx))];
                const int first = std::max(0, -dx), end = std::min(w, w - dx);
                if (first >= end) continue;
                const float *const other = row_of(guide, v), *const known = row_of(weight, v);
                for (int x = first; x < end; ++x) {
                    const float alike = std::max(0.0f, 1 - narrow * sqr(own[x] - other[x + dx]));
                    kernel[size_t(x)] = near * sqr(alike) * known[x + dx];
                    total[size_t(x)] += kernel[size_t(x)];
                }
                for (size_t c = 0; c < planes.size(); ++c) {
                    const float* const from = row_of(*planes[c], v);
                    float* const to = result[c].values.data() + ptrdiff_t(y) * w;
                    for (int x = first; x < end; ++x) to[x] += kernel[size_t(x)] * from[x + dx];
                }
            }
        for (Plane& plane : result)
            for (int x = 0; x < w; ++x)
                plane(x, y) = total[size_t(x)] > 0 ? plane(x, y) / total[size_t(x)] : 0.0f;
    });
    for (size_t c = 0; c < planes.size(); ++c) *planes[c] = std::move(result[c]);
}

}  // namespace covtrace
