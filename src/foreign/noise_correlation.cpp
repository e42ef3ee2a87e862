#include "foreign/noise_correlation.h"

#include <algorithm>
#include <cmath>

#include "core/vec.h"
#include "reconstruction/luminance.h"

namespace covtrace {

namespace {

constexpr int kReach = 6;        // pixels whose differences are one pixel's measure
constexpr float kMostTimes = 3;  // times their mean that a difference counts at most

/// Differences of the halves' luminances over the mean of those around, without its sign.
Plane relative_difference(const Halves& halves) {
    Plane difference = luminance(halves[0].color);
    const Plane other = luminance(halves[1].color);
    for (size_t i = 0; i < other.size(); ++i) difference[i] -= other[i];
    Plane around = difference;
    for (float& v : around.values) v = std::abs(v);
    around = box_blur(around, kReach);
    for (size_t i = 0; i < other.size(); ++i)
        difference[i] =
            around[i] > 0 ? std::clamp(difference[i] / around[i], -kMostTimes, kMostTimes) : 0.0f;
    return difference;
}

}  // namespace

float neighbours_correlation(const Halves& halves) {
    const Plane d = relative_difference(halves);
    double products = 0, squares = 0;
    for (int y = 0; y < d.height; ++y)
        for (int x = 0; x < d.width; ++x) {
            if (x + 1 < d.width) {
                products += double(d(x, y)) * double(d(x + 1, y));
                squares += 0.5 * (sqr(double(d(x, y))) + sqr(double(d(x + 1, y))));
            }
            if (y + 1 < d.height) {
                products += double(d(x, y)) * double(d(x, y + 1));
                squares += 0.5 * (sqr(double(d(x, y))) + sqr(double(d(x, y + 1))));
            }
        }
    return squares > 0 ? float(products / squares) : 0.0f;
}

}  // namespace covtrace
