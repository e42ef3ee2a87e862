#include "reconstruction/feature_filter.h"

#include <algorithm>
#include <array>

#include "core/parallel.h"
#include "core/simd.h"
#include "reconstruction/patch_distance.h"

namespace covtrace {

namespace {

/// Blocks of 32 pixels keep their sums in the first cache; blocks of 48 do not, and take longer.
using Patches = PatchDistance<3, 1, 32>;
constexpr int kReach = 5, kBlock = Patches::kBlock;

/// Sets the features [first, first + n) of `out` to those of one half, filtered with weights from
/// `guide`.
void filter(const HalfBuffer& half, const HalfBuffer& guide, size_t first, size_t n,
            FeaturePlanes& out) {
    const int w = half.count.width, h = half.count.height;
    const Patches distance(std::span(guide.feature).subspan(first, n),
                           std::span(guide.feature_variance).subspan(first, n), kReach);
    std::vector<PaddedPlane> source;
    for (size_t f = first; f < first + n; ++f) source.emplace_back(half.feature[f], kReach);
    const Plane ones(w, h, 1);
    const PaddedPlane inside(ones, kReach, 0);
    const int blocks_x = (w + kBlock - 1) / kBlock, blocks_y = (h + kBlock - 1) / kBlock;
    parallel_for(int64_t(blocks_x) * blocks_y, [&](int64_t block) {
        const int x0 = int(block % blocks_x) * kBlock, y0 = int(block / blocks_x) * kBlock;
        const int x1 = std::min(x0 + kBlock, w), y1 = std::min(y0 + kBlock, h);
        if (distance.is_without_noise(x0, y0)) {
            // Copy the pixels: without noise only equal pixels are alike, and their mean is the
            // pixel but for details that the guide has not seen at all
            for (size_t f = first; f < first + n; ++f)
                for (int y = y0; y < y1; ++y)
                    for (int x = x0; x < x1; ++x) out[f](x, y) = half.feature[f](x, y);
            return;
        }
        std::array<float, kBlock * kBlock> d{};
        std::array<std::array<float, kBlock * kBlock>, 4> total{};
        const auto add = [](const Float8& value, float* to) { store8(load8(to) + value, to); };
        for (int dy = -kReach; dy <= kReach; ++dy)
            for (int dx = -kReach; dx <= kReach; ++dx) {
                // Pixels outside the image have no weight.
                if (!distance.reaches(x0, y0, dx, dy)) continue;
                distance.block(x0, y0, dx, dy, d.data());
                for (int y = 0; y < y1 - y0; ++y) {
                    const float* mask = inside.at(x0 + dx, y0 + y + dy);
                    std::array<const float*, 3> value{};
                    for (size_t f = 0; f < n; ++f) value[f] = source[f].at(x0 + dx, y0 + y + dy);
                    for (int x = 0; x < x1 - x0; x += int(kLanes)) {
                        const size_t i = size_t(y) * kBlock + size_t(x);
                        const Float8 weight = load8(mask + x) * patch_weight(load8(&d[i]));
                        add(weight, &total[3][i]);
                        for (size_t f = 0; f < n; ++f)
                            add(weight * load8(value[f] + x), &total[f][i]);
                    }
                }
            }
        for (int y = y0; y < y1; ++y)
            for (int x = x0; x < x1; ++x) {
                const size_t i = size_t(y - y0) * kBlock + size_t(x - x0);
                // The sum of weights is never 0: the pixel itself has the weight 1.
                for (size_t f = 0; f < n; ++f) out[first + f](x, y) = total[f][i] / total[3][i];
            }
    });
}

}  // namespace

std::array<FeaturePlanes, 2> filter_features(const Halves& halves) {
    std::array<FeaturePlanes, 2> filtered;
    for (size_t k = 0; k < 2; ++k) {
        filtered[k].fill(Plane(halves[k].count.width, halves[k].count.height));
        for (const auto& [first, n] : {std::pair<size_t, size_t>{0, 3}, {3, 3}, {6, 1}})
            filter(halves[k], halves[1 - k], first, n, filtered[k]);
    }
    return filtered;
}

}  // namespace covtrace
