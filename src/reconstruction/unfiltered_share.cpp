#include "reconstruction/unfiltered_share.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/display_exposure.h"
#include "core/vec.h"
#include "reconstruction/luminance.h"

namespace covtrace {

namespace {

/// Deviation in pixels of the Gaussian over which squared differences and variances are averaged:
/// docs/decisions/0097 has the sweep.
constexpr float kNeighbourhood = 2;

/// Squared standard deviations, two of them, beyond which a pixel is an outlier: of so few samples
/// as smooth pixels get, a path that is rare and bright may be met twice, and variances do not
/// know.
constexpr float kOutlier = 4;

/// Squares by pixel, relative to the squared luminance.
struct Squares {
    Plane difference;             ///< squared differences of both images
    Plane raw, gathered, common;  ///< variances of both, and their covariance

    std::array<Plane*, 4> all() { return {&difference, &raw, &gathered, &common}; }
    /// Variance of the difference of both images.
    float of_difference(size_t i) const {
        const float c = std::min(common[i], std::min(raw[i], gathered[i]));
        return raw[i] + gathered[i] - 2 * c;
    }
};

Squares squares_of(const RawLuminance& raw, const FilteredLuminance& filtered) {
    const Plane none(raw.value.width, raw.value.height);
    Squares s{none, none, none, none};
    const float dark = kDarkSquared / sqr(display_exposure(filtered.value));
    for (size_t i = 0; i < none.size(); ++i) {
        const float relative = 1 / (sqr(filtered.value[i]) + dark);
        const float d = relative * sqr(filtered.value[i] - raw.value[i]),
                    r = relative * raw.variance[i], g = relative * filtered.variance[i];
        // Light beyond what squares can hold says nothing, and must not spread.
        if (!raw.known[i] || !std::isfinite(d) || !std::isfinite(r) || !std::isfinite(g)) continue;
        s.difference[i] = d;
        s.raw[i] = r;
        s.gathered[i] = g;
        s.common[i] = filtered.own_weight[i] * r;
    }
    return s;
}

/// Means over neighbourhoods that no outlier decides alone: pixels of larger variance than kOutlier
/// times the mean count for less, and differences count up to so many times their mean.
Squares means_around(Squares s) {
    const Plane with_outliers = gaussian_blur(s.raw, kNeighbourhood);
    for (size_t i = 0; i < s.raw.size(); ++i) {
        const float most = kOutlier * with_outliers[i];
        if (!(s.raw[i] > most)) continue;
        const float part = most / s.raw[i];
        for (Plane* plane : s.all()) (*plane)[i] *= part;
    }
    // The limit is taken twice, as the first one is of means that the outliers are in.
    for (int k = 0; k < 2; ++k) {
        const Plane around = gaussian_blur(s.difference, kNeighbourhood);
        for (size_t i = 0; i < around.size(); ++i)
            s.difference[i] = std::min(s.difference[i], kOutlier * around[i]);
    }
    for (Plane* plane : s.all()) *plane = gaussian_blur(*plane, kNeighbourhood);
    return s;
}

}  // namespace

Plane unfiltered_share(const RawLuminance& raw, const FilteredLuminance& filtered) {
    const Squares own = squares_of(raw, filtered), mean = means_around(own);
    Plane share(raw.value.width, raw.value.height);
    for (size_t i = 0; i < share.size(); ++i) {
        // With a bias b of the filter, variances r and g and the covariance c of both images, the
        // mixture (1 - a) gathered + a raw has the least error at
        // a = (b^2 + g - c) / (b^2 + r + g - 2 c).
        const float c = std::min(mean.common[i], std::min(mean.raw[i], mean.gathered[i]));
        const float bias = std::max(0.0f, mean.difference[i] - mean.of_difference(i));
        const float all = bias + mean.of_difference(i);
        if (all > 0) share[i] = std::clamp((bias + mean.gathered[i] - c) / all, 0.0f, 1.0f);
        // A pixel far noisier than those around it has to be right by its own difference.
        if (own.raw[i] > kOutlier * mean.raw[i] && own.difference[i] > 0)
            share[i] = std::min(
                share[i], std::max(0.0f, 1 - kOutlier * own.of_difference(i) / own.difference[i]));
    }
    return share;
}

}  // namespace covtrace
