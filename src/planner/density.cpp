#include "planner/density.h"

#include <algorithm>
#include <cmath>

namespace covtrace {

std::vector<float> relative_density(const Prediction& prediction, DensityRule rule, float c,
                                    const covariance::FilterLimits<float>& limits) {
    std::vector<float> g(prediction.spectrum.size());
    double sum = 0;
    for (size_t i = 0; i < g.size(); ++i) {
        const auto usable =
            covariance::limit_spectrum(prediction.spectrum[i], c, limits.s_min, limits.s_max);
        const float interior = prediction.interior_count[i];
        g[i] = rule == DensityRule::thesis ? covariance::thesis_density(usable, interior)
                                           : covariance::tempered_density(usable, interior);
        if (!std::isfinite(g[i])) g[i] = 0;
        sum += g[i];
    }
    const float mean = g.empty() ? 0.0f : float(sum / double(g.size()));
    const float even_share = rule == DensityRule::tempered ? 0.1f : 0.0f;
    for (float& v : g) v = covariance::share_of_budget(v, mean, 1.0f, even_share);
    return g;
}

namespace {

/// Whole counts with the sum `total`, or as near to it as `wanted` can come: `wanted(i, level)`
/// grows with the level, which is found by bisection in [lo, hi]; fractions are carried along.
template <typename Wanted>
std::vector<uint32_t> counts_of(size_t n, int64_t total, const Wanted& wanted, double lo,
                                double hi) {
    for (int k = 0; k < 100; ++k) {
        const double mid = 0.5 * (lo + hi);
        double sum = 0;
        for (size_t i = 0; i < n; ++i) sum += wanted(i, mid);
        (sum < double(total) ? lo : hi) = mid;
    }
    constexpr int kFractionBits = 20;
    constexpr int64_t kOne = int64_t{1} << kFractionBits;
    std::vector<uint32_t> counts(n);
    int64_t carried = kOne / 2, given = 0;
    for (size_t i = 0; i < n; ++i) {
        carried += std::llround(wanted(i, hi) * double(kOne));
        const int64_t count = (carried >> kFractionBits) - given;
        counts[i] = static_cast<uint32_t>(count);
        given += count;
    }
    return counts;
}

}  // namespace

std::vector<uint32_t> allocate(std::span<const float> density, int64_t total,
                               std::span<const uint32_t> at_least, uint32_t at_most) {
    const size_t n = density.size();
    const auto wanted = [&](size_t i, double scale) {
        const double lo = at_least[i];
        return std::clamp(scale * double(density[i]), lo, std::max(lo, double(at_most)));
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

std::vector<uint32_t> allocate_unmet(std::span<const float> density, int64_t total,
                                     std::span<const uint32_t> have, uint32_t at_most) {
    const size_t n = density.size();
    const double scale = n > 0 ? double(total) / double(n) : 0.0;
    double most = 0;
    for (size_t i = 0; i < n; ++i)
        most = std::max({most, scale * double(density[i]), double(have[i])});
    const auto wanted = [&](size_t i, double level) {
        const double lo = have[i];
        return std::clamp(scale * double(density[i]) + level, lo, lo + double(at_most));
    };
    // At the lowest level nobody lacks anything; at the highest every pixel is at its limit.
    return counts_of(n, total, wanted, -most, most + double(at_most));
}

}  // namespace covtrace
