/// The anisotropic Gaussian of every pixel, from the predicted spectra: the covariance library's
/// filter fields (covariance/filter_field.hpp), which have the limits by neighbours, and the choice
/// between its rule and the thesis'.
#pragma once

#include <span>
#include <vector>

#include "core/enum_names.h"
#include "covariance/filter_field.hpp"

namespace covtrace {

/// How spectra become filters exp(-2 pi^2 c^2 p^T S p). All but `verified` know no limit by
/// neighbours.
enum class FilterRule {
    verified,  ///< c grows with the count, so that a signal with the predicted spectrum is kept
    matched,   ///< c = 1: the filter's spectrum has the signal's own covariance
    thesis     ///< exp(-pi p^T S p), equation 5.7 of the thesis as printed: c^2 = 1/(2 pi)
};

template <>
inline constexpr auto kEnumNames<FilterRule> =
    enum_names<FilterRule>({{FilterRule::verified, "verified"},
                            {FilterRule::matched, "matched"},
                            {FilterRule::thesis, "thesis"}});

/// c, 1/s_min and the slope follow the samples (docs/decisions/0004, 0047), for emitters in view
/// with other constants (docs/decisions/0012).
using FilterSettings = covariance::FilterSettings<float>;
using FilterField = covariance::FilterField<float>;

/// Primal covariances (pixels^2), row by row: S_h = (4 pi^2 c^2 S2D)^-1 with eigenvalues in
/// [s_min^2, s_max^2]. `spectrum`: width * height predicted spectra after the integral over lens
/// and shutter, (cycles/pixel)^2.
FilterField filter_field(std::span<const covariance::Sym2<float>> spectrum, int width, int height,
                         FilterRule rule, const FilterSettings& settings);

}  // namespace covtrace
