#include "reconstruction/raw_share.h"

#include <algorithm>
#include <array>

#include "core/parallel.h"
#include "core/vec.h"

namespace covtrace {

Plane pixel_noise(const Halves& halves) {
    const Plane& count = halves[0].count;
    Plane noise(count.width, count.height);
    for (size_t k = 0; k < 3; ++k)
        for (size_t i = 0; i < noise.size(); ++i) {
            const float told = halves[0].color_variance[k][i] + halves[1].color_variance[k][i],
                        seen = sqr(halves[0].color[k][i] - halves[1].color[k][i]);
            noise[i] += 0.25f * std::min(told, seen);
        }
    return noise;
}

void lower_share_of_noisy(const Plane& noise, const ColorPlanes& g, const Candidate& raw,
                          const Likeness& likeness, Selection& s) {
    const int w = noise.width, h = noise.height;
    std::vector<MarginPlane> sums(2, MarginPlane(w, h));  // relative noise, pixels
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
            const float weight = g[0](x, y) + g[1](x, y) + g[2](x, y);
            sums[0](x, y) = noise(x, y) * weight;
            sums[1](x, y) = weight > 0 ? 1.0f : 0.0f;  // holes have no samples and no noise
        }
    parallel_for_rows(w, h, [&](int y) {
        for (int x = 0; x < w; ++x) {
            const size_t i = size_t(y) * size_t(w) + size_t(x);
            const float share = s.share[0][i];
            if (!(share > 0 && share < 1)) continue;
            Likeness::Window weights;
            likeness.weigh(x, y, weights);
            std::array<float, 2> sum;
            weighted_sums(sums, weights, x, y, sum.data());
            const float own = *sums[0].at(x, y), mean = sum[0] / sum[1];
            if (!(own > mean && mean > 0)) continue;
            const float worth = share / (share + (1 - share) * own / mean),
                        others = (1 - worth) / (1 - share);
            s.share[0][i] = worth;
            for (size_t c = 1; c < s.share.size(); ++c) s.share[c][i] *= others;
            for (size_t k = 0; k < 2; ++k)
                for (size_t c = 0; c < 3; ++c) {
                    float& mixture = s.half[k][c][i];
                    mixture = others * (mixture - share * raw[k][c][i]) + worth * raw[k][c][i];
                }
        }
    });
}

}  // namespace covtrace
