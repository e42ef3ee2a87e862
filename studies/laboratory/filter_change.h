/// The change of the pixels around one ray by a filter: the judge between two bandwidths.
///
/// A measured bandwidth is relative to the mean, a predicted one to the variation, so that they
/// differ for faint detail (docs/internals/laboratory.md). The change tells which filter would be
/// seen.
#pragma once

#include "covariance/covariance.hpp"
#include "laboratory/fields.h"

namespace covtrace {

struct FilterChange {
    /// Relative change, root mean square over the pixels, without the part that noise adds to it.
    double change = 0;
    double noise = 0;  ///< deviation of one pixel's change; a `change` below half of it is none
};

/// The Gaussian that follows from a spectrum over the sensor: c = 2, deviations in [0.5, 15]
/// pixels. A covariance in pixels^2.
covariance::Sym2<double> filter_of(const covariance::SymmetricMatrix5<double>& sigma);

/// Compares the 5x5 pixels about the field's ray, each a square, over the whole lens and shutter,
/// with themselves through a Gaussian of the given covariance (pixels^2). `samples` are those of
/// all pixels, taken twice. The result is the same for any number of threads.
FilterChange filter_change(const LocalField& field, const covariance::Sym2<double>& filter,
                           uint32_t samples, uint64_t seed);

}  // namespace covtrace
