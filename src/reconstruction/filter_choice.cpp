#include "reconstruction/filter_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/display_exposure.h"
#include "core/vec.h"
#include "reconstruction/luminance.h"

namespace covtrace {

namespace {

/// Deviation in pixels of the Gaussian over which noise and outliers are judged, of that over which
/// estimates of the error are averaged, and of that which smooths the seams.
constexpr float kNeighbourhood = 2, kNearby = 1, kSeam = 1;

/// Difference of estimated errors, as a part of the variance of the raw pixels around, by which a
/// candidate's share falls to 1/e of the best one's.
constexpr float kDoubt = 0.05f;

/// Squared standard deviations beyond which a pixel is an outlier, as in unfiltered_share.cpp.
constexpr float kOutlier = 4;

/// Squared deviations of noise beyond which a filter contradicts a pixel, and the part of the
/// pixels around, by a Gaussian of a pixel, that may be contradicted: docs/decisions/0108.
constexpr float kContradiction = 9, kMayContradict = 0.05f;

/// The noise of the raw image, relative to its brightness as errors are.
struct RelativeNoise {
    Plane relative;  ///< 1 / (L^2 + eps); 0 where nothing is known
    Plane variance, variance_around;
    Plane part;  ///< what outliers count for: those of rare bright paths are noise, not bias
};

RelativeNoise relative_noise(const RawLuminance& raw, const Plane& brightness) {
    const Plane none(raw.value.width, raw.value.height);
    RelativeNoise n{none, none, none, none};
    const float dark = kDarkSquared / sqr(display_exposure(brightness));
    for (size_t i = 0; i < n.relative.size(); ++i) {
        const float relative = 1 / (sqr(brightness[i]) + dark);
        const float variance = relative * raw.variance[i];
        // Light beyond what squares can hold says nothing, and must not spread.
        if (!raw.known[i] || !std::isfinite(variance) || !std::isfinite(sqr(raw.value[i])))
            continue;
        n.relative[i] = relative;
        n.variance[i] = variance;
    }
    n.variance_around = gaussian_blur(n.variance, kNeighbourhood);
    for (size_t i = 0; i < n.part.size(); ++i) {
        const float most = kOutlier * n.variance_around[i];
        n.part[i] = n.variance[i] > most ? most / n.variance[i] : 1;
    }
    return n;
}

/// Estimated squared errors of a candidate, and where pixels contradict it by far.
struct Judgement {
    Plane error, contradicted;
};

Judgement judge(const RawLuminance& raw, const RelativeNoise& noise,
                const FilteredImage& candidate) {
    const Plane none(raw.value.width, raw.value.height);
    Judgement j{none, none};
    Plane expected = none;  // what noise makes of the squared differences beyond the error
    for (size_t i = 0; i < none.size(); ++i) {
        const float relative = noise.relative[i], others = 1 - 2 * candidate.own_weight[i];
        if (relative == 0 || !std::isfinite(candidate.variance[i])) continue;
        const float difference = relative * sqr(luminance(candidate.color[i]) - raw.value[i]);
        if (!std::isfinite(difference)) continue;
        // A pixel that has missed what is rare and bright looks less noisy than it is.
        const float by_noise =
            std::max(others * std::max(noise.variance[i], noise.variance_around[i]) +
                         relative * candidate.variance[i],
                     1e-9f);
        j.contradicted[i] = difference > kContradiction * by_noise ? 1.0f : 0.0f;
        j.error[i] = noise.part[i] * difference;
        expected[i] = noise.part[i] * others * noise.variance[i];
    }
    // The limit is taken twice, as the first one is of means that the outliers are in.
    for (int k = 0; k < 2; ++k) {
        const Plane around = gaussian_blur(j.error, kNeighbourhood);
        for (size_t i = 0; i < around.size(); ++i)
            j.error[i] = std::min(j.error[i], kOutlier * around[i]);
    }
    j.error = gaussian_blur(j.error, kNearby);
    expected = gaussian_blur(expected, kNearby);
    for (size_t i = 0; i < expected.size(); ++i) j.error[i] -= expected[i];
    j.contradicted = gaussian_blur(j.contradicted, kSeam);
    return j;
}

}  // namespace

std::vector<Plane> choose_filters(const RawLuminance& raw,
                                  std::span<const FilteredImage> candidates,
                                  const Plane& brightness) {
    const Plane none(raw.value.width, raw.value.height);
    const RelativeNoise noise = relative_noise(raw, brightness);
    // Errors of the candidates, infinite where one is left out
    std::vector<Plane> errors;
    for (const FilteredImage& candidate : candidates) {
        Judgement j = judge(raw, noise, candidate);
        for (size_t i = 0; i < none.size() && !errors.empty(); ++i)
            if (j.contradicted[i] > kMayContradict || !std::isfinite(candidate.variance[i]))
                j.error[i] = std::numeric_limits<float>::infinity();
        errors.push_back(std::move(j.error));
    }
    // Shares by how sure the differences are
    Plane doubt = none;
    for (size_t i = 0; i < none.size(); ++i) doubt[i] = noise.part[i] * noise.variance[i];
    doubt = gaussian_blur(doubt, kNearby);
    std::vector<Plane> shares(candidates.size(), none);
    for (size_t i = 0; i < none.size(); ++i) {
        const float unit = std::max(kDoubt * doubt[i], 1e-9f);
        float least = errors.front()[i], all = 0;
        for (const Plane& error : errors) least = std::min(least, error[i]);
        if (!(doubt[i] > 0) && least == errors.front()[i]) {
            shares.front()[i] = 1;
            continue;
        }
        for (size_t k = 0; k < shares.size(); ++k)
            all += shares[k][i] = std::exp(-(errors[k][i] - least) / unit);
        for (Plane& share : shares) share[i] /= all;
    }
    for (Plane& share : shares) share = gaussian_blur(share, kSeam);
    return shares;
}

FilteredImage mixed(std::span<const FilteredImage> candidates, std::span<const Plane> shares) {
    const size_t n = candidates.front().color.size();
    FilteredImage m{std::vector<Rgb>(n), std::vector<float>(n), std::vector<float>(n)};
    for (size_t i = 0; i < n; ++i) {
        float deviation = 0, all = 0;
        for (size_t k = 0; k < candidates.size(); ++k) {
            const FilteredImage& c = candidates[k];
            const float share = shares[k][i];
            // A neighbour's choice reaches here by the smoothed seam, and may have nothing here.
            if (share == 0 || !std::isfinite(c.variance[i])) continue;
            m.color[i] += share * c.color[i];
            m.own_weight[i] += share * c.own_weight[i];
            deviation += share * std::sqrt(c.variance[i]);
            all += share;
        }
        if (!(all > 0)) {
            m.color[i] = candidates.front().color[i];
            continue;
        }
        m.color[i] *= 1 / all;
        m.own_weight[i] /= all;
        m.variance[i] = sqr(deviation / all);
    }
    return m;
}

}  // namespace covtrace
