#include "reconstruction/raw_share.h"

#include <algorithm>

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

std::array<Plane, 2> relative_noise(const Plane& noise, const ColorPlanes& g) {
    std::array<Plane, 2> planes;
    planes.fill(Plane(noise.width, noise.height));
    for (size_t i = 0; i < noise.size(); ++i) {
        const float weight = g[0][i] + g[1][i] + g[2][i];
        planes[0][i] = noise[i] * weight;
        planes[1][i] = weight > 0 ? 1.0f : 0.0f;  // holes have no samples and no noise
    }
    return planes;
}

void lower_share_of_noisy(const Plane& noise, std::span<const Plane> around, const Candidate& raw,
                          Selection& s) {
    parallel_for_rows(noise.width, noise.height, [&](int y) {
        for (int x = 0; x < noise.width; ++x) {
            const size_t i = size_t(y) * size_t(noise.width) + size_t(x);
            const float share = s.share[0][i];
            if (!(share > 0 && share < 1)) continue;
            const float own = noise[i], mean = around[0][i] / around[1][i];
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
