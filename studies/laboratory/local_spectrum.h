/// The measured counterpart of a predicted covariance: the bandwidth of a light field around one
/// ray, from nothing but its values at neighbouring rays.
///
/// The field is looked at through a Gaussian window. With z its whitened coordinates, g the field
/// and < > the mean over the window, the coefficients
///
///     H_ij = <g He_ij(z)>/<g>,    T_ijk = <g He_ijk(z)>/<g>          (Hermite polynomials)
///
/// are the mean second and third derivatives of g there (Stein's identity), so no difference is
/// ever taken and edges and noise do no harm. The bandwidth is the size of the second derivative
/// over the window, root mean square: 4 pi^2 Sigma = (H~^2 + sum_k T_k T_k)^(1/2), H~ being H
/// without the smoothing of the window where the field peaks (-l/(1 + l) for an eigenvalue l < 0).
/// This size decides how much a Gaussian filter changes the field; it is 0 for a ramp, and equal to
/// 1/(4 pi^2 S), the covariance of its amplitude spectrum, at the centre of a Gaussian of
/// covariance S.
///
/// The window is the field's own: it has the covariance (4 pi^2 c^2 Sigma)^-1, c = 2, which is the
/// reconstruction filter that follows from Sigma. It is found by iteration, from a narrow one
/// outwards.
#pragma once

#include "covariance/covariance.hpp"
#include "laboratory/fields.h"

namespace covtrace {

struct MeasureOptions {
    /// Samples of the final window; all earlier ones together take as many.
    uint32_t samples = 1u << 18;
    uint64_t seed = 0;
    /// Axes along which the field may vary; on the others its noise is not taken for variation.
    std::array<bool, 5> axes{true, true, true, true, true};
    /// Standard deviations of the largest window: pixels, lens radii, shutter intervals. Those of
    /// lens and shutter keep four deviations inside the aperture and the shutter.
    double widest_pixels = 15, widest_lens = 0.25, widest_shutter = 0.125;
};

struct MeasuredSpectrum {
    covariance::SymmetricMatrix5<double> sigma;  ///< covariance in the units of the sensor map
    /// Standard error of sqrt(sigma_ii), by leaving out one of the independent batches at a time.
    std::array<double, 5> bandwidth_error{};
    std::array<double, 5> window{};  ///< standard deviations of the final window
    double mean = 0;                 ///< mean of the field in the window; 0: nothing was measured
};

/// Whether a bandwidth bends the field within the widest window: slower variation along that axis
/// is below what lens, shutter or filter can tell from none, and not measured well.
bool is_resolved(double variance, size_t axis, const MeasureOptions& options);

/// Measures the field. The result is the same for any number of threads.
MeasuredSpectrum measure(const LocalField& field, const MeasureOptions& options);

}  // namespace covtrace
