#include "reconstruction/outliers.h"

#include <algorithm>

#include "core/vec.h"

namespace covtrace {

namespace {

/// How many times brighter than all that the other half saw around it a pixel may be.
constexpr float kMostTimes = 2;
/// Deviation of the Gaussian that spreads what is given back, pixels.
constexpr float kSpread = 12;

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

void return_energy(const ColorPlanes& raw, ColorPlanes& color) {
    const Plane light = luminance(color);
    // Where everything around is black the light goes everywhere alike.
    constexpr float kFloor = 1e-6f;
    const Plane around = gaussian_sum(light, kSpread);
    for (size_t c = 0; c < 3; ++c) {
        Plane share = raw[c];
        for (size_t i = 0; i < share.size(); ++i)
            share[i] = (share[i] - color[c][i]) / (around[i] + kFloor);
        share = gaussian_sum(share, kSpread);
        for (size_t i = 0; i < share.size(); ++i)
            color[c][i] = std::max(0.0f, color[c][i] + share[i] * (light[i] + kFloor));
    }
}

}  // namespace covtrace
