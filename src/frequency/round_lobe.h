/// Reflection by a GGX lobe of one roughness, in closed form: the result that ggx_derivatives.h and
/// cov::reflection_pair give together for any lobe, for a third of the instructions. Such a lobe
/// knows the normal and no tangents, so that every derivative is a combination of a few vectors and
/// of squares of them.
#pragma once

#include "bsdf/bsdf.h"
#include "covariance/covariance.hpp"

namespace covtrace {

struct RoundReflection {
    covariance::Frame<double> outgoing;  ///< the arriving frame, mirrored
    /// Window of masking and its cosine on the arriving light, in arriving slopes, 1/rad^2; at most
    /// cov::cosine_window.
    covariance::Sym2<double> window;
    /// The lobe at this pair of directions (cov::local_lobe), in leaving slopes.
    covariance::Sym2<double> lobe;
};

/// Reflects by `lobe`, a glossy reflection with alpha_x = alpha_y. `in` is the frame of the
/// arriving ray, z its direction of travel; `outgoing` (unit) the direction in which the light
/// leaves; `n` the unit normal, on either side.
RoundReflection round_reflection(const LobeShare& lobe, const covariance::Frame<double>& in,
                                 const covariance::Vec3<double>& outgoing,
                                 const covariance::Vec3<double>& n);

}  // namespace covtrace
