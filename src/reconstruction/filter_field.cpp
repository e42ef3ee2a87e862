#include "reconstruction/filter_field.h"

#include "core/parallel.h"

namespace covtrace {

FilterField filter_field(std::span<const covariance::Sym2<float>> spectrum, int width, int height,
                         FilterRule rule, const FilterSettings& settings) {
    FilterField f{width, height, std::vector<covariance::Sym2<float>>(spectrum.size())};
    parallel_for(f.height, [&](int64_t row) {
        for (size_t i = size_t(row) * size_t(f.width), end = i + size_t(f.width); i < end; ++i) {
            const auto quadratic =
                rule == FilterRule::verified
                    ? covariance::filter_quadratic(spectrum[i], settings.c, settings.limits)
                    : covariance::thesis_filter_quadratic(spectrum[i], settings.limits);
            f.covariance[i] = covariance::finite_filter_covariance(quadratic, settings.limits);
        }
    });
    return f;
}

}  // namespace covtrace
