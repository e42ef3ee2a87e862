#include "reconstruction/light_in_place.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "core/vec.h"
#include "reconstruction/guides.h"
#include "reconstruction/luminance.h"

namespace covtrace {

namespace {

/// Reach within which light is one thing, pixels: a small lamp in view covers a few of them.
constexpr int kTogether = 3;
/// Share of all light around by which one thing may make it brighter. More would be seen as a glow
/// over the whole image, and stays where it is.
constexpr float kMostOfOneThing = 0.065f;

/// The largest limit such that what is left of `values` below it sums up to `most`. The values are
/// sorted, and sum up to more.
float limit_of_sum(std::vector<float>& values, float most) {
    std::ranges::sort(values);
    float below = 0;
    for (size_t i = 0; i < values.size(); ++i) {
        const auto above = float(values.size() - i);
        if (below + above * values[i] > most) return std::max(0.0f, most - below) / above;
        below += values[i];
    }
    return kInfinity;
}

/// Adds what of e is above the limit on its luminance.
void add_above(const ColorPlanes& e, size_t pixel, float size, float limit, ColorPlanes& color) {
    if (!(size > limit)) return;
    for (size_t c = 0; c < 3; ++c) color[c][pixel] += (1 - limit / size) * e[c][pixel];
}

}  // namespace

void keep_in_place(const Plane& around, const ColorPlanes& e, ColorPlanes& color) {
    Plane size = luminance(e);
    for (float& v : size.values) v = std::abs(v);
    const Plane together = box_blur(size, kTogether);
    std::vector<float> thing;
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) {
            const float most = kMostOfOneThing * around(x, y);
            if (!(sqr(2 * kTogether + 1.0f) * together(x, y) > most)) continue;
            thing.clear();
            for (int v = std::max(0, y - kTogether); v <= std::min(size.height - 1, y + kTogether);
                 ++v)
                for (int u = std::max(0, x - kTogether);
                     u <= std::min(size.width - 1, x + kTogether); ++u)
                    thing.push_back(size(u, v));
            const float limit = limit_of_sum(thing, most);
            add_above(e, size_t(y) * size_t(size.width) + size_t(x), size(x, y), limit, color);
        }
}

void keep_brightest(const ColorPlanes& e, float luminance_kept, ColorPlanes& color) {
    const Plane light = luminance(e);
    std::vector<float> bright;
    for (float v : light.values) bright.push_back(std::max(0.0f, v));
    const double rest = std::accumulate(bright.begin(), bright.end(), -double(luminance_kept));
    const float limit = rest > 0 ? limit_of_sum(bright, float(rest)) : 0;
    for (size_t i = 0; i < light.size(); ++i) add_above(e, i, light[i], limit, color);
}

}  // namespace covtrace
