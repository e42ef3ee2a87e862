// Samples for every pixel out of one budget, in proportion to a density such as N = k sqrt|Sigma|
// (Belcour 2012, "A Frequency Analysis of Light Transport: From Theory to Implementation", section
// 5.1). Allocates: one of the headers for whole images, see renderer.hpp.
#pragma once

#include <cstdint>
#include <optional>
#include <ranges>
#include <span>
#include <vector>

#include "covariance/covariance_image.hpp"
#include "covariance/filter.hpp"

namespace covariance {

/// Densities side by side, one per pixel: a vector or span of floats or doubles.
template <typename Densities>
concept DensityRange = std::ranges::contiguous_range<Densities> &&
    std::floating_point<std::ranges::range_value_t<Densities>>;

/// Rules for a pixel's density of samples, from the two members of its `Prediction`: the spectrum
/// S2D and the count N_int.
enum class DensityRule {
    tempered,  ///< n ~ sqrt( sqrt(det S2D) min(N_int, 4) ), a tenth of it shared out evenly
    thesis     ///< Belcour 2012, equation 5.3 as a Schur complement: n ~ sqrt(det S2D) N_int
};

namespace detail {

/// Densities `density(spectrum, N_int)` of all pixels, with spectra limited to those that filters
/// can use; 0 where not finite.
template <std::floating_point T, typename Density>
[[nodiscard]] std::vector<T> usable_densities(const Prediction<T>& prediction, T c,
                                              const FilterLimits<T>& limits,
                                              const Density& density) {
    std::vector<T> g(prediction.spectrum.size());
    for (std::size_t i = 0; i < g.size(); ++i) {
        const Sym2<T> usable =
            limit_spectrum(prediction.spectrum[i], c, limits.s_min, limits.s_max);
        g[i] = density(usable, prediction.interior_count[i]);
        if (!std::isfinite(g[i])) g[i] = 0;
    }
    return g;
}

}  // namespace detail

/// Densities by a rule, without a norm; 0 where they are not finite. The spectra are first limited
/// to what filters of width factor `c` and the given limits can use (`limit_spectrum`), so that no
/// pixel asks for detail that the narrowest filter would remove.
template <std::floating_point T>
[[nodiscard]] std::vector<T> densities(const Prediction<T>& prediction, DensityRule rule,
                                       NonDeduced<T> c, const FilterLimits<NonDeduced<T>>& limits) {
    return detail::usable_densities<T>(
        prediction, c, limits, [rule](const Sym2<T>& usable, T interior) {
            return rule == DensityRule::thesis ? thesis_density(usable, interior)
                                               : tempered_density(usable, interior);
        });
}

/// Samples per pixel by N = k sqrt|S| for k = 1 (Belcour 2012, section 5.1; see
/// `hypercube_density`), from spectra limited as in `densities`; 0 where not finite.
template <std::floating_point T>
[[nodiscard]] std::vector<T> hypercube_counts(const Prediction<T>& prediction, NonDeduced<T> c,
                                              const FilterLimits<NonDeduced<T>>& limits) {
    return detail::usable_densities<T>(prediction, c, limits, hypercube_density<T>);
}

/// Densities by a rule, scaled to mean 1; the tempered rule shares a tenth out evenly.
template <std::floating_point T>
[[nodiscard]] std::vector<T> relative_density(const Prediction<T>& prediction, DensityRule rule,
                                              NonDeduced<T> c,
                                              const FilterLimits<NonDeduced<T>>& limits) {
    std::vector<T> g = densities(prediction, rule, c, limits);
    double sum = 0;
    for (const T v : g) sum += v;
    const T mean = g.empty() ? T(0) : T(sum / double(g.size()));
    const T even = rule == DensityRule::tempered ? T(0.1) : T(0);
    for (T& v : g) v = share_of_budget(v, mean, T(1), even);
    return g;
}

namespace detail {

/// The level in [lo, hi] at which the sum of `wanted(i, level)`, which grows with it, is `total`;
/// the end that comes nearest where no level does. By regula falsi whose kept end counts half (the
/// Illinois method: Dowell and Jarratt 1971, "A modified regula falsi method for computing the root
/// of an equation", BIT 11), and every third time by halves.
template <typename Wanted>
double level_of(std::size_t n, std::int64_t total, const Wanted& wanted, double lo, double hi) {
    const auto excess = [&](double level) {
        double sum = 0;
        for (std::size_t i = 0; i < n; ++i) sum += wanted(i, level);
        return sum - double(total);
    };
    double at_lo = excess(lo), at_hi = excess(hi);
    if (at_hi <= 0) return hi;
    if (at_lo >= 0) return lo;
    // The tolerance is far below what a pixel's fraction resolves.
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

/// Whole counts near `wanted(i, level)`, with the same sum but for rounding: fractions are carried
/// along from pixel to pixel.
template <typename Wanted>
std::vector<std::uint32_t> counts_of(std::size_t n, const Wanted& wanted, double level) {
    constexpr int fraction_bits = 20;
    constexpr std::int64_t one = std::int64_t{1} << fraction_bits;
    std::vector<std::uint32_t> counts(n);
    std::int64_t carried = one / 2, given = 0;
    for (std::size_t i = 0; i < n; ++i) {
        carried += std::llround(wanted(i, level) * double(one));
        const std::int64_t count = (carried >> fraction_bits) - given;
        counts[i] = static_cast<std::uint32_t>(count);
        given += count;
    }
    return counts;
}

/// Multiples of a density, never below `at_least` nor above `most(i)`. Of a density that is below
/// zero or not a number `at_least` is the multiple, of an infinite one `most(i)`.
template <std::floating_point T, typename Most>
struct Multiple {
    std::span<const T> density;
    std::span<const std::uint32_t> at_least;
    Most most;

    double operator()(std::size_t i, double factor) const {
        const double lo = at_least[i], wanted = factor * double(density[i]);
        return wanted > lo ? std::min(wanted, std::max(lo, most(i))) : lo;
    }
    double sum(double factor) const {
        double s = 0;
        for (std::size_t i = 0; i < density.size(); ++i) s += (*this)(i, factor);
        return s;
    }
    /// The factor with which the sum is, or comes nearest to, `total`.
    double factor_of(std::int64_t total) const {
        // Densities have any unit: the factor is sought as far above the one that no limit changes.
        double all = 0;
        for (const T d : density)
            if (d > 0 && std::isfinite(d)) all += double(d);
        const double free = all > 0 ? std::min(double(total) / all, 1e295) : 1;
        double hi = 1;
        while (sum(hi) < double(total) && hi < 1e12 * std::max(1.0, free)) hi *= 2;
        return level_of(density.size(), total, *this, 0, hi);
    }
};

/// Multiples of densities in float or double, with the same upper limit everywhere.
template <DensityRange Densities>
auto multiple_below(const Densities& density, std::span<const std::uint32_t> at_least,
                    std::uint32_t at_most) {
    auto most = [at_most](std::size_t) { return double(at_most); };
    return Multiple<std::ranges::range_value_t<Densities>, decltype(most)>{density, at_least, most};
}

}  // namespace detail

/// Sample counts with the given total, as near to one multiple of the density as the limits of each
/// pixel allow: at least `at_least`, at most `most(i)`, of which the former prevails.
template <std::floating_point T, typename Most>
[[nodiscard]] std::vector<std::uint32_t> counts_by_density(std::span<const T> density,
                                                           std::int64_t total,
                                                           std::span<const std::uint32_t> at_least,
                                                           const Most& most) {
    const detail::Multiple<T, Most> multiple{density, at_least, most};
    return detail::counts_of(density.size(), multiple, multiple.factor_of(total));
}

/// Sample counts with the given total, as near to a multiple of `density` as `at_least` (per
/// pixel, what has been taken already) and `at_most` (one number) allow. The sum is exactly `total`
/// where the limits allow it, else as near to it as they do. Fractions are carried along the rows.
/// Where the density is zero, below, or not a number a pixel keeps what it has; where it is
/// infinite the pixel gets `at_most`.
template <DensityRange Densities>
[[nodiscard]] std::vector<std::uint32_t> allocate(const Densities& density, std::int64_t total,
                                                  std::span<const std::uint32_t> at_least,
                                                  std::uint32_t at_most) {
    const auto multiple = detail::multiple_below(density, at_least, at_most);
    return detail::counts_of(std::size(density), multiple, multiple.factor_of(total));
}

/// The multiple of the density that `allocate` gives with the same arguments, wherever the limits
/// leave a pixel free: the k of Belcour 2012, section 5.1, where the density is `hypercube_counts`.
/// None where the limits keep every multiple below the total.
template <DensityRange Densities>
[[nodiscard]] std::optional<double> density_factor(const Densities& density, std::int64_t total,
                                                   std::span<const std::uint32_t> at_least,
                                                   std::uint32_t at_most) {
    constexpr double rounding = 1e-6;
    const auto multiple = detail::multiple_below(density, at_least, at_most);
    const double factor = multiple.factor_of(total);
    if (multiple.sum(factor) < (1 - rounding) * double(total)) return std::nullopt;
    return factor;
}

/// The average count of `factor` times the density between the same limits; `density_factor` is the
/// inverse, from that count to the factor.
template <DensityRange Densities>
[[nodiscard]] double mean_count(const Densities& density, double factor,
                                std::span<const std::uint32_t> at_least, std::uint32_t at_most) {
    return detail::multiple_below(density, at_least, at_most).sum(factor) /
           double(std::size(density));
}

}  // namespace covariance
