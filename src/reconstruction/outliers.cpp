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
/// Pixels within this reach bring light together: what a lamp covers in the image is no
/// surroundings of itself.
constexpr int kTogether = 3;
/// How much brighter light from far away may make a place. More would be seen as a glow over the
/// whole image, and stays where it came from: a small lamp in view (docs/decisions/0077).
constexpr float kMostFromFar = 0.1f;

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

Plane absolute(Plane p) {
    for (float& v : p.values) v = std::abs(v);
    return p;
}

/// Where everything around is black the light goes everywhere alike.
constexpr float kFloor = 1e-6f;

/// By what part of its light every place becomes brighter if `from` is given to `light`.
Plane brightening(const ColorPlanes& from, const Plane& light, float spread) {
    const Plane around = gaussian_sum(light, spread);
    Plane share = absolute(luminance(from));
    for (size_t i = 0; i < share.size(); ++i) share[i] /= around[i] + kFloor;
    return gaussian_sum(share, spread);
}

/// Gives every pixel's light to what is around it, in proportion to the light that is there.
void give(const ColorPlanes& from, const Plane& light, float spread, ColorPlanes& to) {
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
    // Pixel filters with negative lobes make rare light negative, too.
    const std::array<Plane, 2> bright{absolute(luminance(halves[0].color)),
                                      absolute(luminance(halves[1].color))};
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

ReturnedShares return_energy(const ColorPlanes& raw, ColorPlanes& color) {
    const Plane light = luminance(color);
    const size_t n = light.size();
    ColorPlanes near = raw;
    for (size_t c = 0; c < 3; ++c)
        for (size_t i = 0; i < n; ++i) near[c][i] -= color[c][i];
    const Plane brought = absolute(luminance(near)), all = gaussian_sum(brought, kSpread),
                together = box_blur(brought, kTogether);
    ColorPlanes far = near;
    ReturnedShares share{Plane(light.width, light.height), Plane(light.width, light.height)};
    bool any = false;
    for (size_t i = 0; i < n; ++i) {
        constexpr float kOwn = 1 / (2 * std::numbers::pi_v<float> * sqr(kSpread));
        const float own = kOwn * brought[i],
                    others = all[i] - kOwn * sqr(2 * kTogether + 1.0f) * together[i],
                    most = kMostOfOthers * std::max(0.0f, others);
        share.near[i] = own > most ? sqr(most / own) : 1.0f;
        any = any || share.near[i] < 1;
        for (size_t c = 0; c < 3; ++c) {
            near[c][i] *= share.near[i];
            far[c][i] -= near[c][i];
        }
    }
    give(near, light, kSpread, color);
    if (any) {
        const Plane brighter = brightening(far, light, kWideSpread);
        for (size_t i = 0; i < n; ++i) {
            const float kept =
                std::max(0.0f, 1 - kMostFromFar / std::max(brighter[i], kMostFromFar));
            share.own[i] = kept * (1 - share.near[i]);
            for (size_t c = 0; c < 3; ++c) {
                color[c][i] += kept * far[c][i];
                far[c][i] *= 1 - kept;
            }
        }
        give(far, light, kWideSpread, color);
    }
    for (Plane& channel : color)
        for (float& v : channel.values) v = std::max(0.0f, v);
    return share;
}

}  // namespace covtrace
