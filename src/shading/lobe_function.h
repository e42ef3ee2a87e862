/// The shape of one lobe as a function of both directions, written once for every scalar type: with
/// scalars that carry derivatives it gives the lobe's exact gradient and Hessian.
///
/// V is a vector with members x, y, z, the operations +, scalar * vector and dot; Vec3 is one.
#pragma once

#include <cmath>

#include "shading/bsdf.h"
#include "shading/fresnel.h"
#include "shading/ggx.h"

namespace covtrace {

/// Fresnel's factor for what a border reflects, `cos_i` > 0; 1 without a border.
template <typename S>
S border_reflectance(const LobeShare& lobe, const S& cos_i) {
    using std::sqrt;
    if (!(lobe.border_eta > 0)) return S(1.0f);
    if (lobe.border_k > 0) return conductor_reflectance(cos_i, lobe.border_eta, lobe.border_k);
    const S cos2_t = 1 - (1 - cos_i * cos_i) / (lobe.border_eta * lobe.border_eta);
    return cos2_t > 0.0f ? dielectric_reflectance(cos_i, S(sqrt(cos2_t)), lobe.border_eta)
                         : S(1.0f);
}

/// A lobe's BRDF (or BTDF) times |cos(wi)| without constant factors: for a glossy lobe its value
/// where the border's indices are grey. A diffuse lobe below a coat is seen through the coat's
/// smooth border on both sides; roughness makes that softer.
///
/// `wo`, `wi`: unit, local, away from the surface. Zero for pairs that the lobe does not connect.
template <typename V>
auto lobe_function(const LobeShare& lobe, V wo, V wi) {
    using std::abs;
    using std::sqrt;
    using S = std::decay_t<decltype(wo.x + wi.x)>;
    if (wo.z < 0.0f) {
        wo.z = -wo.z;
        wi.z = -wi.z;
    }
    if (lobe.kind == LobeKind::diffuse_reflection || lobe.kind == LobeKind::diffuse_transmission) {
        const S cos_i = abs(wi.z);
        if (!(lobe.border_eta > 0)) return cos_i;
        return S((1 - border_reflectance(lobe, wo.z)) * (1 - border_reflectance(lobe, cos_i)) *
                 cos_i);
    }
    const Ggx ggx{lobe.alpha_x, lobe.alpha_y};
    const bool reflects = lobe.kind == LobeKind::glossy_reflection;
    const V half = reflects ? wo + wi : wo + S(lobe.eta) * wi;
    const S half_length2 = dot(half, half);
    if (!(half_length2 > 0.0f) || reflects != (wi.z > 0.0f)) return S(0.0f);
    const S scale = 1 / sqrt(half_length2);
    const V m = (half.z < 0.0f ? S(-scale) : scale) * half;
    const S cos_o = dot(wo, m), cos_i = dot(wi, m);
    if (!(cos_o > 0.0f) || reflects != (cos_i > 0.0f)) return S(0.0f);
    const S fresnel = border_reflectance(lobe, cos_o);
    if (reflects) return S(0.25f * fresnel * ggx.d(m) * ggx.g2_over_cos_o(wo, wi));
    V mirrored = wi;
    mirrored.z = -wi.z;
    return S((1 - fresnel) * ggx.d(m) * ggx.g2_over_cos_o(wo, mirrored) * cos_o * -cos_i /
             half_length2);
}

/// The part of a glossy lobe's `lobe_function` that is not a function of the half vector: masking,
/// and with it the cosine of wi.
template <typename V>
auto masked_cosine(const LobeShare& lobe, V wo, V wi) {
    using std::abs;
    wo.z = abs(wo.z);
    wi.z = abs(wi.z);
    return Ggx{lobe.alpha_x, lobe.alpha_y}.g2_over_cos_o(wo, wi);
}

}  // namespace covtrace
