/// Pearson's chi-square test of counts against expectations, and Šidák's correction for many tests.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace covtrace {

/// Upper tail of the chi-square distribution: the regularised incomplete gamma function Q(degrees /
/// 2, value / 2), by its series or its continued fraction (Numerical Recipes, section 6.2).
inline double chi_square_tail(double value, double degrees) {
    const double a = degrees / 2, x = value / 2;
    if (x <= 0) return 1;
    const double scale = std::exp(a * std::log(x) - x - std::lgamma(a));
    if (x < a + 1) {
        double term = 1 / a, sum = term;
        for (double n = a + 1; term > 1e-15 * sum; ++n) sum += term *= x / n;
        return 1 - sum * scale;
    }
    double b = x + 1 - a, c = 1e300, d = 1 / b, h = d;
    for (int i = 1; i < 100000; ++i) {
        const double an = -i * (i - a);
        b += 2;
        d = 1 / (an * d + b);
        c = b + an / c;
        h *= d * c;
        if (std::abs(d * c - 1) < 1e-15) break;
    }
    return h * scale;
}

struct ChiSquare {
    double value = 0;
    int degrees = 0;
    double p = 1;  ///< probability of a value as large if the expectations are right
};

/// Tests counts against expectations. Cells are pooled from the smallest expectation on until each
/// pool expects five.
inline ChiSquare chi_square_test(std::span<const double> observed,
                                 std::span<const double> expected) {
    std::vector<size_t> order(expected.size());
    for (size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(),
              [&](size_t a, size_t b) { return expected[a] < expected[b]; });
    ChiSquare result;
    double pool_observed = 0, pool_expected = 0;
    int cells = 0;
    for (size_t i : order) {
        pool_observed += observed[i];
        pool_expected += expected[i];
        if (pool_expected < 5) continue;
        result.value +=
            (pool_observed - pool_expected) * (pool_observed - pool_expected) / pool_expected;
        ++cells;
        pool_observed = pool_expected = 0;
    }
    result.degrees = std::max(cells - 1, 1);
    result.p = chi_square_tail(result.value, result.degrees);
    return result;
}

/// Significance of each of `tests` independent tests, so that any of them alarms falsely with
/// probability `total`.
inline double sidak(double total, size_t tests) {
    return 1 - std::pow(1 - total, 1.0 / static_cast<double>(tests));
}

}  // namespace covtrace
