/// First and second derivatives of the logarithm of a GGX reflection and of its masking, in closed
/// form: those that `lobe_function` and Ggx::g2_over_cos_o give with scalars that carry
/// derivatives, for less than half of the instructions. The distribution is Trowbridge's and
/// Reitz', the masking Smith's with correlated heights (Heitz 2014, "Understanding the
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

/// Derivatives of log f = log(BRDF * cos) of a glossy reflection about the leaving direction `wo`;
/// the value is left 0. `wi` points towards the light. Empty where the lobe reflects nothing.
std::optional<covariance::Jet<double>> log_reflection(const LobeShare& lobe, LocalAxes wo,
                                                      covariance::Vec3<double> wi);

/// Derivatives of the logarithm of masking with its cosine, G2 / cos(wo), times the solid angle per
/// area of slopes, about the direction `wi` towards the light.
covariance::Jet<double> log_masked_cosine(const LobeShare& lobe, covariance::Vec3<double> wo,
                                          LocalAxes wi);

}  // namespace covtrace
