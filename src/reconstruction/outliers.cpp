#include "reconstruction/outliers.h"

#include <algorithm>
#include <cmath>

#include "reconstruction/luminance.h"

namespace covtrace {

namespace {

/// Factor by which a pixel may be brighter than all that the other half saw around it.
constexpr float kMostTimes = 2;

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

}  // namespace

void limit_outliers(Halves& halves) {
    // Absolute values are compared: pixel filters with negative lobes make rare light negative,
    // too.
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
                // The rare path made the variance, too: the part of the pixel that is left varies
                // less.
                halves[k].color_variance[c][i] *= keep * keep;
            }
        }
    }
}

}  // namespace covtrace
