/// First and second derivatives of the logarithm of a GGX reflection and of its masking, in closed
/// form. They are those of `lobe_function` and Ggx::g2_over_cos_o, evaluated in jets
/// (covariance/jet.hpp), for less than half of the instructions. The distribution is Trowbridge's
/// and Reitz', the masking Smith's with correlated heights (Heitz 2014, "Understanding the
/// Masking-Shadowing Function in Microfacet-Based BRDFs", equations 85 and 99); the derivatives are
/// our own.
#pragma once

#include <optional>

#include "bsdf/bsdf.h"
#include "covariance/covariance.hpp"

namespace covtrace {

/// Axes of a ray in the coordinates of the BSDF: the slopes (u, v) stand for the direction z + u x
/// + v y, normalised.
struct LocalAxes {
    covariance::Vec3<double> x, y, z;
};

/// Derivatives of log f, f = BRDF times the cosine of wi, of a glossy reflection by the slopes of
/// `wo` about the leaving direction wo.z; the value is left 0. `wi` is the unit direction towards
/// the light, in the coordinates of the BSDF. Empty where the lobe reflects nothing.
std::optional<covariance::Jet<double>> log_reflection(const LobeShare& lobe, LocalAxes wo,
                                                      covariance::Vec3<double> wi);

/// Derivatives of the logarithm of masking over the cosine of wo, G2 / cos(wo), times the solid
/// angle per area of slopes, (1 + u^2 + v^2)^(-3/2), by the slopes of `wi` about the direction wi.z
/// towards the light; the value is left 0. `wo` is a unit vector in the coordinates of the BSDF.
covariance::Jet<double> log_masked_cosine(const LobeShare& lobe, covariance::Vec3<double> wo,
                                          LocalAxes wi);

}  // namespace covtrace
