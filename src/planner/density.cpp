#include "planner/density.h"

#include <algorithm>
#include <cmath>

namespace covtrace {

namespace {

/// With mean 1, a share of it even.
std::vector<float> relative(std::vector<float> g, float even_share) {
    double sum = 0;
    for (const float v : g) sum += v;
    const float mean = g.empty() ? 0.0f : float(sum / double(g.size()));
    for (float& v : g) v = covariance::share_of_budget(v, mean, 1.0f, even_share);
    return g;
}

constexpr float kEvenShare = 0.1f;

std::vector<float> densities(const Prediction& prediction, DensityRule rule, float c,
                             const covariance::FilterLimits<float>& limits) {
    std::vector<float> g(prediction.spectrum.size());
    for (size_t i = 0; i < g.size(); ++i) {
        const auto usable =
            covariance::limit_spectrum(prediction.spectrum[i], c, limits.s_min, limits.s_max);
        const float interior = prediction.interior_count[i];
        g[i] = rule == DensityRule::thesis ? covariance::thesis_density(usable, interior)
                                           : covariance::tempered_density(usable, interior);
        if (!std::isfinite(g[i])) g[i] = 0;
    }
    return g;
}

}  // namespace

std::vector<float> relative_density(const Prediction& prediction, DensityRule rule, float c,
                                    const covariance::FilterLimits<float>& limits) {
    return relative(densities(prediction, rule, c, limits),
                    rule == DensityRule::tempered ? kEvenShare : 0.0f);
}

Plane emphasis(const Prediction& prediction, DensityRule rule, float c,
               const covariance::FilterLimits<float>& limits) {
    constexpr float kExponent = 0.7f, kSmoothing = 3;  // pixels
    Plane beyond(prediction.width, prediction.height, 1);
    if (rule == DensityRule::tempered) return beyond;
    const std::vector<float> asked = densities(prediction, rule, c, limits),
                             tempered = densities(prediction, DensityRule::tempered, c, limits);
    for (size_t i = 0; i < beyond.size(); ++i)
        beyond[i] = tempered[i] > 0 ? std::pow(asked[i] / tempered[i], kExponent) : 0.0f;
    return gaussian_blur(beyond, kSmoothing);
}

namespace {

/// The level in [lo, hi] at which the sum of `wanted(i, level)`, which grows with it, is `total`:
/// by regula falsi whose kept end counts half (the Illinois method: Dowell and Jarratt, BIT 11,
/// 1971), and every third time by halves. The end that comes nearest where no level does.
template <typename Wanted>
double level_of(size_t n, int64_t total, const Wanted& wanted, double lo, double hi) {
    const auto excess = [&](double level) {
        double sum = 0;
        for (size_t i = 0; i < n; ++i) sum += wanted(i, level);
        return sum - double(total);
    };
    double at_lo = excess(lo), at_hi = excess(hi);
    if (at_hi <= 0) return hi;
    if (at_lo >= 0) return lo;
    // Far below what a pixel's fraction resolves.
    const double tolerance = 1e-12 * double(total);
    int side = 0;
    for (int k = 0; k < 100; ++k) {
        const double middle = 0.5 * (lo + hi), secant = lo - at_lo * (hi - lo) / (at_hi - at_lo);
        const double level = k % 3 < 2 && secant > lo && secant < hi ? secant : middle;
        const double found = excess(level);
        if (std::abs(found) <= tolerance || !(lo < middle && middle < hi)) return level;
        if (found < 0) {
            lo = level, at_lo = found;
            if (side < 0) at_hi *= 0.5;
            side = -1;
        } else {
            hi = level, at_hi = found;
            if (side > 0) at_lo *= 0.5;
            side = 1;
        }
    }
    return hi;
}

/// Whole counts with the sum `total`, or as near to it as `wanted` can come in [lo, hi]; fractions
/// are carried along.
template <typename Wanted>
std::vector<uint32_t> counts_of(size_t n, int64_t total, const Wanted& wanted, double lo,
                                double hi) {
    const double level = level_of(n, total, wanted, lo, hi);
    constexpr int kFractionBits = 20;
    constexpr int64_t kOne = int64_t{1} << kFractionBits;
    std::vector<uint32_t> counts(n);
    int64_t carried = kOne / 2, given = 0;
    for (size_t i = 0; i < n; ++i) {
        carried += std::llround(wanted(i, level) * double(kOne));
        const int64_t count = (carried >> kFractionBits) - given;
        counts[i] = static_cast<uint32_t>(count);
        given += count;
    }
    return counts;
}

/// Counts as near to one multiple of the density as `most(i)`, never below `at_least`, allows.
template <typename Most>
std::vector<uint32_t> counts_by_density(std::span<const float> density, int64_t total,
                                        std::span<const uint32_t> at_least, const Most& most) {
    const size_t n = density.size();
    const auto wanted = [&](size_t i, double scale) {
        const double lo = at_least[i];
        return std::clamp(scale * double(density[i]), lo, std::max(lo, most(i)));
    };
    const auto sum = [&](double scale) {
        double s = 0;
        for (size_t i = 0; i < n; ++i) s += wanted(i, scale);
        return s;
    };
    double hi = 1;
    while (sum(hi) < double(total) && hi < 1e12) hi *= 2;
    return counts_of(n, total, wanted, 0, hi);
}

}  // namespace

std::vector<uint32_t> allocate(std::span<const float> density, int64_t total,
                               std::span<const uint32_t> at_least, uint32_t at_most) {
    return counts_by_density(density, total, at_least, [&](size_t) { return double(at_most); });
}

std::vector<uint32_t> allocate_on_demand(std::span<const float> density, int64_t total,
                                         std::span<const uint32_t> have, uint32_t at_most) {
    return counts_by_density(density, total, have,
                             [&](size_t i) { return double(have[i]) + double(at_most); });
}

}  // namespace covtrace
