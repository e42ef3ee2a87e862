/// Scattering by a strand of hair: light of a cone about the strand leaves in a cone.
///
/// What a strand scatters hangs on the sum of the angles theta of both directions to its cross
/// section and on the difference of their angles phi about it. So it is a pair of directions as
/// those of glossy surfaces are: slopes along the strand are those of a mirror across it, slopes
/// about it are turned with phi, and the lobe is the product of both widths. Its logarithm is as
/// convex in the tails as it is concave at the peak, or more, so that the lobe at the peak is the
/// one at every pair of directions (covariance/RULES.md, 1).
#pragma once

#include "bsdf/bsdf.h"
#include "covariance/covariance.hpp"

namespace covtrace {

/// The pair of directions that a strand along `axis` (unit) joins. `lobe` is one of hair; `in` the
/// frame of the arriving ray, z its direction of travel; `outgoing` (unit) the direction in which
/// the light leaves. Directions within 0.02 of the strand's count as 0.02 away from it.
covariance::GlossyPair<double> strand_pair(const LobeShare& lobe,
                                           const covariance::Vec3<double>& axis,
                                           const covariance::Frame<double>& in,
                                           const covariance::Vec3<double>& outgoing);

}  // namespace covtrace
