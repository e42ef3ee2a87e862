#include "reconstruction/filter_field.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace covtrace {

FilterSettings filter_settings(double samples_per_pixel) {
    const double n = std::max(samples_per_pixel, 1.0 / 64);
    FilterSettings s;
    s.c = float(covariance::filter_sharpness(n));
    s.limits.s_min = 0.5f * 2 / s.c;
    s.slope = covariance::edge_beta<float> / s.c;
    return s;
}

FilterSettings filter_settings_in_view(double samples_per_pixel) {
    FilterSettings s = filter_settings(samples_per_pixel);
    s.c *= std::sqrt(2.0f);
    s.limits.s_min = 0.1f;  // the next pixel gets exp(-50) of it
    return s;
}

FilterField filter_field(std::span<const covariance::Sym2<float>> spectrum, int width, int height,
                         FilterRule rule, const FilterSettings& settings) {
    FilterField f{width, height, std::vector<covariance::Sym2<float>>(spectrum.size())};
    parallel_for(f.height, [&](int64_t row) {
        for (size_t i = size_t(row) * size_t(f.width), end = i + size_t(f.width); i < end; ++i) {
            const auto quadratic =
                rule == FilterRule::verified
                    ? covariance::filter_quadratic(spectrum[i], settings.c, settings.limits)
                    : covariance::thesis_filter_quadratic(spectrum[i], settings.limits);
            covariance::Sym2<float>& filter = f.covariance[i];
            filter = covariance::filter_covariance(quadratic);
            // Of a spectrum beyond the range of floats, which damaged films have: no smoothing.
            if (!std::isfinite(filter.xx + filter.xy + filter.yy)) {
                const float narrowest = settings.limits.s_min * settings.limits.s_min;
                filter = covariance::Sym2<float>::diagonal(narrowest, narrowest);
            }
        }
    });
    return f;
}

namespace {

/// What is left of sizes of `width` columns that may grow by `slope` a pixel from a smaller one.
/// Chamfer distance transform with steps 1 and sqrt 2: one pass down, one pass up.
void limit_growth(std::vector<float>& sizes, int width, int height, float slope) {
    const float diagonal = slope * std::sqrt(2.0f);
    const auto relax = [&](int x, int y, int dx, int dy, float step) {
        const int px = x + dx, py = y + dy;
        if (px < 0 || py < 0 || px >= width || py >= height) return;
        float& here = sizes[size_t(y) * size_t(width) + size_t(x)];
        here = std::min(here, sizes[size_t(py) * size_t(width) + size_t(px)] + step);
    };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            relax(x, y, -1, 0, slope);
            relax(x, y, 0, -1, slope);
            relax(x, y, -1, -1, diagonal);
            relax(x, y, 1, -1, diagonal);
        }
    for (int y = height - 1; y >= 0; --y)
        for (int x = width - 1; x >= 0; --x) {
            relax(x, y, 1, 0, slope);
            relax(x, y, 0, 1, slope);
            relax(x, y, 1, 1, diagonal);
            relax(x, y, -1, 1, diagonal);
        }
}

}  // namespace

void limit_by_neighbours(FilterField& field, const FilterSettings& settings,
                         std::span<const float> others) {
    std::vector<float> s(field.covariance.size());
    for (size_t i = 0; i < s.size(); ++i) s[i] = covariance::filter_size(field.covariance[i]);
    std::vector<float> limit = s;
    for (size_t i = 0; i < others.size(); ++i) limit[i] = std::min(limit[i], others[i]);
    limit_growth(limit, field.width, field.height, settings.slope);
    for (size_t i = 0; i < s.size(); ++i)
        if (limit[i] < s[i])
            field.covariance[i] =
                covariance::resize_filter(field.covariance[i], limit[i], settings.limits);
}

void limit_lengths_by_neighbours(FilterField& field, const FilterSettings& settings) {
    std::vector<float> length(field.covariance.size());
    for (size_t i = 0; i < length.size(); ++i)
        length[i] = std::sqrt(std::max(0.0f, covariance::eigen(field.covariance[i]).high));
    std::vector<float> limit = length;
    limit_growth(limit, field.width, field.height, settings.slope);
    for (size_t i = 0; i < length.size(); ++i)
        if (limit[i] < length[i])
            field.covariance[i] =
                covariance::clamp_eigenvalues(field.covariance[i], 0.0f, limit[i] * limit[i]);
}

void make_round_where_unknown(FilterField& field, const std::vector<bool>& known,
                              const FilterSettings& settings) {
    std::vector<float> sizes(field.covariance.size());
    for (size_t i = 0; i < sizes.size(); ++i)
        sizes[i] = known[i] ? std::sqrt(std::max(0.0f, covariance::eigen(field.covariance[i]).low))
                            : covariance::filter_size(field.covariance[i]);
    limit_growth(sizes, field.width, field.height, settings.slope);
    for (size_t i = 0; i < sizes.size(); ++i)
        if (!known[i])
            field.covariance[i] =
                covariance::Sym2<float>::diagonal(sizes[i] * sizes[i], sizes[i] * sizes[i]);
}

}  // namespace covtrace
