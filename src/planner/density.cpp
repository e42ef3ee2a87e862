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
    // The sum grows with the scale, linearly but for the limits: by turns the secant, which is
    // exact where no limit is met, and bisection, until the fixed-point rounding with carry below
    // gives exactly `total`.
    const auto goal = double(total);
    double lo = 0, hi = 1, sum_lo = sum(lo), sum_hi = sum(hi);
    while (sum_hi < goal && hi < 1e12) {
        lo = hi;
        sum_lo = sum_hi;
        hi *= 2;
        sum_hi = sum(hi);
    }
    for (int i = 0; i < 200 && sum_hi - goal > 0.25 && sum_hi > sum_lo; ++i) {
        const double share = i % 2 == 0 ? std::max(0.0, (goal - sum_lo) / (sum_hi - sum_lo)) : 0.5;
        const double mid = lo + share * (hi - lo), at_mid = sum(mid);
        if (std::abs(at_mid - goal) <= 0.25 || at_mid >= goal) {
            hi = mid;
            sum_hi = at_mid;
        } else {
            lo = mid;
            sum_lo = at_mid;
        }
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

}  // namespace covtrace
