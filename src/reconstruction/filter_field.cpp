#include "reconstruction/filter_field.h"

#include "core/parallel.h"

namespace covtrace {

namespace {

covariance::Sym2<float> quadratic(const covariance::Sym2<float>& spectrum, FilterRule rule,
                                  const FilterSettings& settings) {
    if (rule == FilterRule::thesis)
        return covariance::thesis_filter_quadratic(spectrum, settings.limits);
    const float c = rule == FilterRule::matched ? 1.0f : settings.c;
    return covariance::filter_quadratic(spectrum, c, settings.limits);
}

}  // namespace

FilterField filter_field(std::span<const covariance::Sym2<float>> spectrum, int width, int height,
                         FilterRule rule, const FilterSettings& settings) {
    FilterField f{width, height, std::vector<covariance::Sym2<float>>(spectrum.size())};
    parallel_for_rows(f.width, f.height, [&](int row) {
        for (size_t i = size_t(row) * size_t(f.width), end = i + size_t(f.width); i < end; ++i) {
            f.covariance[i] = covariance::finite_filter_covariance(
                quadratic(spectrum[i], rule, settings), settings.limits);
        }
    });
    return f;
}

}  // namespace covtrace
