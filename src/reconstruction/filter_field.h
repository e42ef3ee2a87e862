/// The anisotropic Gaussian of every pixel, from the predicted spectra.
#pragma once

#include <span>
#include <vector>

#include "covariance/covariance.hpp"

namespace covtrace {

/// How spectra become filters. `verified` is the constant that keeps a signal with the predicted
/// spectrum; `thesis` prints exp(-pi p^T S p), equation 5.7 to the letter, with no limit by
/// neighbours.
enum class FilterRule { verified, thesis };

struct FilterSettings {
    float c = 2;  ///< widening of the filter's spectrum beside the signal's
    covariance::FilterLimits<float> limits{0.5f, 15};  ///< of the standard deviations, pixels
    float slope = 0.1f;  ///< how fast a filter may widen away from a narrower one, pixels per pixel
};
/// The settings for an average of `samples_per_pixel` samples: c and 1/s_min grow as n^(1/6), so
/// that the bias falls as the noise does. The slope is beta / c, beta = 0.5: an edge at a distance
/// of r pixels makes a filter of the deviation beta r / c, and a narrow neighbour stands for an
/// edge that the pixel's own paths may not know (docs/decisions/0047).
FilterSettings filter_settings(double samples_per_pixel);

/// The same for light from emitters in view (CovarianceBuffers): with no floor to speak of, since
/// such light has no noise but at its border and what the tail of a filter carries over it is seen;
/// and half as wide in variance, since out of focus it shows the hard border of the aperture, whose
/// spectrum reaches further than the Gaussian's with the same moments (docs/decisions/0012).
FilterSettings filter_settings_in_view(double samples_per_pixel);

/// Primal covariances (pixels^2), row by row: S_h = (4 pi^2 c^2 S2D)^-1 with eigenvalues in
/// [s_min^2, s_max^2].
struct FilterField {
    int width = 0, height = 0;
    std::vector<covariance::Sym2<float>> covariance;
};
/// `spectrum`: width * height predicted spectra after the integral over lens and shutter,
/// (cycles/pixel)^2.
FilterField filter_field(std::span<const covariance::Sym2<float>> spectrum, int width, int height,
                         FilterRule rule, const FilterSettings& settings);

/// Narrows filters near narrower ones: s = det(S_h)^(1/4) becomes min over q of s(q) + slope |p -
/// q|. `others`, if not empty, are sizes s of other filters, one per pixel, that limit this field
/// too: a border is one for all the light that meets there.
void limit_by_neighbours(FilterField& field, const FilterSettings& settings,
                         std::span<const float> others = {});

/// The same for each filter's longer deviation alone, which the size s of a thin filter hides:
/// along a straight border it would reach as far as a lamp that stands at the border.
void limit_lengths_by_neighbours(FilterField& field, const FilterSettings& settings);

/// Where no path met the light (`known` is false; one per pixel), its directions are those of light
/// from afar, and a long filter that has them would reach beyond all that its size was limited by.
/// Such filters become round, as narrow as neighbours that know their light are across: their short
/// side is the border that a round filter would reach over (docs/decisions/0083).
void make_round_where_unknown(FilterField& field, const std::vector<bool>& known,
                              const FilterSettings& settings);

}  // namespace covtrace
