/// Filter fields: the anisotropic Gaussian of every pixel, from the predicted spectra. They are
/// those of the covariance library (covariance/filter_field.hpp), which have the limits by
/// neighbours, with the choice between its rule and that of Belcour 2012.
#pragma once

#include <span>
#include <vector>

#include "core/enum_names.h"
#include "covariance/filter_field.hpp"

namespace covtrace {

/// Rules by which spectra become filters exp(-2 pi^2 c^2 p^T S p). `verified` and `predicted` are
/// limited by narrower neighbours.
enum class FilterRule {
    verified,   ///< as `predicted`, then wider, or mixed with raw pixels, where samples say so
    predicted,  ///< c grows with the count, so that a signal with the predicted spectrum is kept
    matched,    ///< c = 1: the filter's spectrum has the signal's own covariance
    thesis      ///< exp(-pi p^T S p), Belcour 2012, equation 5.7 as printed: c^2 = 1/(2 pi)
};

template <>
inline constexpr auto kEnumNames<FilterRule> =
    enum_names<FilterRule>({{FilterRule::verified, "verified"},
                            {FilterRule::predicted, "predicted"},
                            {FilterRule::matched, "matched"},
                            {FilterRule::thesis, "thesis"}});

/// Settings of filters: c, 1/s_min and the slope follow the samples (docs/decisions/0004, 0047),
/// for emitters in view with other constants (docs/decisions/0012).
using FilterSettings = covariance::FilterSettings<float>;
using FilterField = covariance::FilterField<float>;

/// Makes a field of primal covariances (pixels^2), row by row: S_h = (4 pi^2 c^2 S2D)^-1 with
/// eigenvalues in [s_min^2, s_max^2]. `spectrum`: width * height predicted spectra after the
/// integral over lens and shutter, (cycles/pixel)^2.
FilterField filter_field(std::span<const covariance::Sym2<float>> spectrum, int width, int height,
                         FilterRule rule, const FilterSettings& settings);

}  // namespace covtrace
