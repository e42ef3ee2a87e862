// The Gaussian filter of every pixel, and the limit by its sharper neighbours, without which a
// surface next to an edge that its own paths do not know is smeared over that edge.
//
//   s'(p) = min over pixels q of s(q) + slope |p - q|,   s = det(S_h)^(1/4),  slope = beta / c
//
// Allocates: one of the headers for whole images, see renderer.hpp.
#pragma once

#include <span>
#include <vector>

#include "covariance/covariance_image.hpp"
#include "covariance/filter.hpp"
#include "covariance/texture.hpp"

namespace covariance {

template <std::floating_point T = float>
struct FilterSettings {
    T c = 2;                             ///< widening of the filter's spectrum beside the signal's
    FilterLimits<T> limits{T(0.5), 15};  ///< of the standard deviations, pixels
    T slope = T(0.1);  ///< how fast a filter may widen away from a narrower one, pixels per pixel
};

/// The settings for an average of `samples_per_pixel` samples: c and 1/s_min grow as n^(1/6), so
/// that the bias falls as the noise does. The slope is beta / c, beta = 0.5: an edge at a distance
/// of r pixels makes a filter of the deviation beta r / c, and a narrow neighbour stands for an
/// edge that the pixel's own paths may not know.
template <std::floating_point T = float>
[[nodiscard]] FilterSettings<T> filter_settings(double samples_per_pixel) {
    const double n = std::max(samples_per_pixel, 1.0 / 64);
    FilterSettings<T> s;
    s.c = T(filter_sharpness(n));
    s.limits.s_min = T(0.5) * 2 / s.c;
    s.slope = edge_beta<T> / s.c;
    return s;
}

/// The settings for light from emitters in view (directly, or by mirrors and clear glass alone).
/// Their filters have no floor to speak of, since such light has no noise but at its border, and
/// the part that the tail of a filter carries over it is seen. They are half as wide in variance,
/// since out of focus such light shows the hard border of the aperture, whose spectrum reaches
/// further than the Gaussian's with the same moments.
template <std::floating_point T = float>
[[nodiscard]] FilterSettings<T> filter_settings_in_view(double samples_per_pixel) {
    FilterSettings<T> s = filter_settings<T>(samples_per_pixel);
    s.c *= std::sqrt(T(2));
    s.limits.s_min = T(0.1);  // the next pixel gets exp(-50) of it
    return s;
}

/// Filters exp(-p^T S_h^-1 p / 2) of an image by their covariances S_h, pixels^2, row by row.
template <std::floating_point T = float>
struct FilterField {
    int width = 0, height = 0;
    std::vector<Sym2<T>> covariance;
};

/// Covariance of a filter, Q^-1; the narrowest filter where that is not finite, as for spectra
/// beyond the range of T.
template <std::floating_point T>
[[nodiscard]] Sym2<T> finite_filter_covariance(const Sym2<T>& quadratic,
                                               const FilterLimits<NonDeduced<T>>& limits) noexcept {
    const Sym2<T> filter = filter_covariance(quadratic);
    if (std::isfinite(filter.xx + filter.xy + filter.yy)) return filter;
    return Sym2<T>::diagonal(limits.s_min * limits.s_min, limits.s_min * limits.s_min);
}

/// Filters of all pixels: S_h = (4 pi^2 c^2 S2D)^-1 with eigenvalues in [s_min^2, s_max^2].
template <std::floating_point T>
[[nodiscard]] FilterField<T> filter_field(const Prediction<T>& prediction,
                                          const FilterSettings<NonDeduced<T>>& settings) {
    FilterField<T> field{prediction.width, prediction.height, {}};
    field.covariance.reserve(prediction.spectrum.size());
    for (const Sym2<T>& spectrum : prediction.spectrum)
        field.covariance.push_back(finite_filter_covariance(
            filter_quadratic(spectrum, settings.c, settings.limits), settings.limits));
    return field;
}

namespace detail {

/// Limits sizes, in rows of `width`: each may exceed a smaller one by no more than `slope` a pixel
/// of their distance. Chamfer distance transform with steps 1 and sqrt 2: one pass down, one pass
/// up.
template <std::floating_point T>
void limit_growth(std::vector<T>& sizes, int width, int height, T slope) {
    const T diagonal_slope = slope * std::sqrt(T(2));
    sweep_neighbours(width, height, [&](std::size_t i, std::size_t j, bool diagonal) {
        sizes[i] = std::min(sizes[i], sizes[j] + (diagonal ? diagonal_slope : slope));
    });
}

}  // namespace detail

/// Narrows filters near narrower ones: s = det(S_h)^(1/4) becomes min over q of s(q) + slope |p -
/// q|. `others`, if not empty, are sizes s of other filters, one per pixel, that limit this field
/// too: a border is one for all the light that meets there. A field without pixels stays so.
template <std::floating_point T>
void limit_by_neighbours(FilterField<T>& field, const FilterSettings<NonDeduced<T>>& settings,
                         std::span<const NonDeduced<T>> others = {}) {
    std::vector<T> s(field.covariance.size());
    for (std::size_t i = 0; i < s.size(); ++i) s[i] = filter_size(field.covariance[i]);
    std::vector<T> limit = s;
    for (std::size_t i = 0; i < std::min(limit.size(), others.size()); ++i)
        limit[i] = std::min(limit[i], others[i]);
    detail::limit_growth(limit, field.width, field.height, settings.slope);
    for (std::size_t i = 0; i < s.size(); ++i)
        if (limit[i] < s[i])
            field.covariance[i] = resize_filter(field.covariance[i], limit[i], settings.limits);
}

/// Limits each filter's longer deviation alone, as `limit_by_neighbours` does for its size s, which
/// hides the length of a thin filter: along a straight border it would reach as far as a lamp that
/// stands at the border.
template <std::floating_point T>
void limit_lengths_by_neighbours(FilterField<T>& field,
                                 const FilterSettings<NonDeduced<T>>& settings) {
    std::vector<T> length(field.covariance.size());
    for (std::size_t i = 0; i < length.size(); ++i)
        length[i] = std::sqrt(std::max(T(0), eigen(field.covariance[i]).high));
    std::vector<T> limit = length;
    detail::limit_growth(limit, field.width, field.height, settings.slope);
    for (std::size_t i = 0; i < length.size(); ++i)
        if (limit[i] < length[i])
            field.covariance[i] = clamp_eigenvalues(field.covariance[i], T(0), limit[i] * limit[i]);
}

/// Makes filters round where no path met the light (`known` is false; one per pixel): there a
/// filter's directions are those of light from afar, and a long filter that has them would reach
/// beyond all that its size was limited by. They become as narrow as neighbours that know their
/// light are across: the short side of these is the border that a round filter would reach over.
template <std::floating_point T>
void make_round_where_unknown(FilterField<T>& field, const std::vector<bool>& known,
                              const FilterSettings<NonDeduced<T>>& settings) {
    std::vector<T> sizes(field.covariance.size());
    for (std::size_t i = 0; i < sizes.size(); ++i)
        sizes[i] = known[i] ? std::sqrt(std::max(T(0), eigen(field.covariance[i]).low))
                            : filter_size(field.covariance[i]);
    detail::limit_growth(sizes, field.width, field.height, settings.slope);
    for (std::size_t i = 0; i < sizes.size(); ++i)
        if (!known[i])
            field.covariance[i] = Sym2<T>::diagonal(sizes[i] * sizes[i], sizes[i] * sizes[i]);
}

/// The sizes s of filters where the covariances know light, at least `smallest`; infinite
/// elsewhere: `others` for the field of another part of the light.
template <std::floating_point T>
[[nodiscard]] std::vector<T> known_sizes(const FilterField<T>& field,
                                         const std::vector<bool>& known, NonDeduced<T> smallest) {
    std::vector<T> sizes(field.covariance.size(), std::numeric_limits<T>::infinity());
    for (std::size_t i = 0; i < sizes.size(); ++i)
        if (known[i]) sizes[i] = std::max(smallest, filter_size(field.covariance[i]));
    return sizes;
}

/// Filters of both parts of the light: scattered by surfaces, and of emitters in view.
template <std::floating_point T = float>
struct PartFilters {
    FilterField<T> scattered, in_view;
};

/// Limits the filters of both parts by their neighbours and by each other: a border between a
/// surface and the sky behind it is known to the light that passes beside it.
template <std::floating_point T>
void limit_parts(FilterField<T>& scattered, FilterField<T>& in_view,
                 const std::vector<bool>& scattered_known, const std::vector<bool>& in_view_known,
                 const FilterSettings<NonDeduced<T>>& settings,
                 const FilterSettings<NonDeduced<T>>& settings_in_view) {
    const auto beside = known_sizes(in_view, in_view_known, settings.limits.s_min);
    limit_by_neighbours(scattered, settings, beside);
    limit_by_neighbours(in_view, settings_in_view, known_sizes(scattered, scattered_known, 0));
    limit_lengths_by_neighbours(in_view, settings_in_view);
    make_round_where_unknown(scattered, scattered_known, settings);
    make_round_where_unknown(in_view, in_view_known, settings_in_view);
}

/// For every pixel whether it or one within `radius` columns and rows has a weight.
template <std::floating_point T>
[[nodiscard]] std::vector<bool> known_within(const CovarianceImage<T>& part, int radius) {
    const auto index = [&](int x, int y) {
        return std::size_t(y) * std::size_t(part.width) + std::size_t(x);
    };
    std::vector<bool> known(part.weight.size());
    for (int y = 0; y < part.height; ++y)
        for (int x = 0; x < part.width; ++x)
            for (int py = std::max(0, y - radius); py <= std::min(part.height - 1, y + radius);
                 ++py)
                for (int px = std::max(0, x - radius); px <= std::min(part.width - 1, x + radius);
                     ++px)
                    if (part.weight[index(px, py)] > 0) known[index(x, y)] = true;
    return known;
}

/// The filters of an image whose light is kept in two parts, from covariances to limits: all that
/// the gather needs, in one call.
///
/// `scattered`: of light that a surface sent on; `in_view`: of emitters seen directly or through
/// mirrors and clear glass alone. Both have one size; where there is no light of a part, leave its
/// image as it was made, or hand over one of 0x0 pixels. The filters have that size in any case.
/// `scattered_radius`, in pixels: how far from a pixel with scattered light others count as pixels
/// that know theirs. At least 1, what `smooth` looks at; more may suit lamps that are found by
/// chance, where most pixels have no light in the few paths with covariances; then the covariance
/// of the nearest pixel with light is trusted from further away.
template <std::floating_point T>
[[nodiscard]] PartFilters<T> filters_of_parts(const CovarianceImage<T>& scattered,
                                              const CovarianceImage<NonDeduced<T>>& in_view,
                                              double samples_per_pixel, int scattered_radius = 1) {
    if (scattered.weight.empty() != in_view.weight.empty()) {
        const CovarianceImage<T> dark(std::max(scattered.width, in_view.width),
                                      std::max(scattered.height, in_view.height));
        return filters_of_parts(scattered.weight.empty() ? dark : scattered,
                                in_view.weight.empty() ? dark : in_view, samples_per_pixel,
                                scattered_radius);
    }
    const FilterSettings<T> settings = filter_settings<T>(samples_per_pixel),
                            bright = filter_settings_in_view<T>(samples_per_pixel);
    PartFilters<T> filters{filter_field(preintegrate(smooth(scattered)), settings),
                           filter_field(preintegrate(smooth(in_view)), bright)};
    // Pixels beside one with light are known, too: they take its covariance in `smooth`.
    limit_parts<T>(filters.scattered, filters.in_view,
                   known_within(scattered, std::max(1, scattered_radius)),
                   known_within<T>(in_view, 1), settings, bright);
    return filters;
}

}  // namespace covariance
