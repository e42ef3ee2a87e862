#include "reconstruction/outliers.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/vec.h"

namespace covtrace {

namespace {

/// How many times brighter than all that the other half saw around it a pixel may be.
constexpr float kMostTimes = 2;
/// Deviations of the Gaussians that spread what is given back, pixels.
constexpr float kSpread = 12, kWideSpread = kWidening * kSpread;
/// What one pixel may bring to its surroundings of what all others bring there: more is the light
/// of one path, which would be seen as a blotch, and is spread widely (docs/decisions/0069).
constexpr float kMostOfOthers = 0.1f;

/// Largest value within 3 x 3 pixels.
Plane largest_around(const Plane& p) {
    Plane result(p.width, p.height);
    for (int y = 0; y < p.height; ++y)
        for (int x = 0; x < p.width; ++x) {
            float most = 0;
            for (int qy = std::max(0, y - 1); qy <= std::min(p.height - 1, y + 1); ++qy)
                for (int qx = std::max(0, x - 1); qx <= std::min(p.width - 1, x + 1); ++qx)
                    most = std::max(most, p(qx, qy));
            result(x, y) = most;
        }
    return result;
}

/// Gives every pixel's light to what is around it, in proportion to the light that is there.
void give(const ColorPlanes& from, const Plane& light, float spread, ColorPlanes& to) {
    // Where everything around is black the light goes everywhere alike.
    constexpr float kFloor = 1e-6f;
    const Plane around = gaussian_sum(light, spread);
    for (size_t c = 0; c < 3; ++c) {
        Plane share = from[c];
        for (size_t i = 0; i < share.size(); ++i) share[i] /= around[i] + kFloor;
        share = gaussian_sum(share, spread);
        for (size_t i = 0; i < share.size(); ++i) to[c][i] += share[i] * (light[i] + kFloor);
    }
}

}  // namespace

Plane luminance(const ColorPlanes& color) {
    Plane y(color[0].width, color[0].height);
    for (size_t i = 0; i < y.size(); ++i)
        y[i] = luminance(Rgb(color[0][i], color[1][i], color[2][i]));
    return y;
}

void limit_outliers(Halves& halves) {
    const std::array<Plane, 2> bright{luminance(halves[0].color), luminance(halves[1].color)};
    for (size_t k = 0; k < 2; ++k) {
        const Plane limit = largest_around(bright[1 - k]);
        for (size_t i = 0; i < limit.size(); ++i) {
            const float most = kMostTimes * limit[i];
            if (!(bright[k][i] > most)) continue;
            const float keep = most / bright[k][i];
            for (size_t c = 0; c < 3; ++c) {
                halves[k].color[c][i] *= keep;
                // The rare path made the variance too; what is left of the pixel varies less.
                halves[k].color_variance[c][i] *= keep * keep;
            }
        }
    }
}

Plane return_energy(const ColorPlanes& raw, ColorPlanes& color) {
    const Plane light = luminance(color);
    const size_t n = light.size();
    ColorPlanes near = raw;
    for (size_t c = 0; c < 3; ++c)
        for (size_t i = 0; i < n; ++i) near[c][i] -= color[c][i];
    Plane brought = luminance(near);
    for (float& v : brought.values) v = std::abs(v);
    const Plane all = gaussian_sum(brought, kSpread);
    ColorPlanes far = near;
    Plane share(light.width, light.height);
    bool any = false;
    for (size_t i = 0; i < n; ++i) {
        const float own = brought[i] / (2 * std::numbers::pi_v<float> * sqr(kSpread)),
                    most = kMostOfOthers * (all[i] - own);
        share[i] = own > most ? std::max(0.0f, most) / own : 1.0f;
        any = any || share[i] < 1;
        for (size_t c = 0; c < 3; ++c) {
            near[c][i] *= share[i];
            far[c][i] -= near[c][i];
        }
    }
    give(near, light, kSpread, color);
    if (any) give(far, light, kWideSpread, color);
    for (Plane& channel : color)
        for (float& v : channel.values) v = std::max(0.0f, v);
    return share;
}

}  // namespace covtrace
