/// The shape of one lobe as a function of both directions, written once for every scalar type: with
/// scalars that carry derivatives it gives the lobe's exact gradient and Hessian.
///
/// V is a vector with members x, y, z, the operations +, scalar * vector and dot; Vec3 is one.
#pragma once

#include <cmath>

#include "bsdf/bsdf.h"
#include "bsdf/fresnel.h"
#include "bsdf/ggx.h"
#include "bsdf/sheen.h"
#include "core/frame.h"

namespace covtrace {

/// The function f of x; types that carry derivatives have an overload of their own.
template <typename F>
auto function_of(const F& f, float x) {
    return f(x);
}
template <typename F>
auto function_of(const F& f, double x) {
    return f(x);
}

/// Fresnel reflectance of the border that a lobe belongs to (`LobeShare::border_eta`, or
/// `border_metal`), for `cos_i` > 0; 1 without a border.
template <typename S>
S border_reflectance(const LobeShare& lobe, const S& cos_i) {
    if (!lobe.has_border()) return S(1.0f);
    return function_of(
        [&lobe](const auto& c) {
            using std::sqrt;
            using C = std::decay_t<decltype(c)>;
            if (lobe.border_metal) return C(schlick_reflectance(c, *lobe.border_metal));
            if (lobe.border_k > 0)
                return C(conductor_reflectance(c, lobe.border_eta, lobe.border_k));
            const C cos2_t = 1 - (1 - c * c) / (lobe.border_eta * lobe.border_eta);
            if (!(cos2_t > 0.0f)) return C(1.0f);
            const C r = dielectric_reflectance(c, C(sqrt(cos2_t)), lobe.border_eta);
            return lobe.is_pane ? C(2 * r / (1 + r)) : r;
        },
        cos_i);
}

/// The vector `v` about another normal than z: its components along the axes of `frame`.
template <typename V>
V turned_to(const Frame& frame, const V& v) {
    const auto along = [&v](Vec3 axis) { return axis.x * v.x + axis.y * v.y + axis.z * v.z; };
    return V{along(frame.x), along(frame.y), along(frame.z)};
}

/// A lobe's BRDF (or BTDF) times |cos(wi)| without constant factors: for a glossy lobe its value
/// where the border's indices are grey. A diffuse lobe below a coat is multiplied by what a smooth
/// border lets through along wo and along wi, though a rough one is softer.
///
/// `wo`, `wi`: unit, local, away from the surface, of either's own type (a direction that is
/// constant need not carry derivatives). A glossy lobe is zero for pairs that it does not connect;
/// for a diffuse lobe callers see to it that wi is on the lobe's side. Left out are of a sheen the
/// factor that keeps its albedo below 1, and the gain of multiple scattering, which hangs on wo
/// alone and varies far slower than the lobe.
template <typename O, typename I>
auto lobe_function(const LobeShare& lobe, O wo, I wi) {
    using std::abs;
    using std::sqrt;
    using S = std::decay_t<decltype(wo.x + wi.x)>;
    if (std::abs(lobe.normal.z) != 1) {
        const Frame frame = Frame::from_z(lobe.normal);
        wo = turned_to(frame, wo);
        wi = turned_to(frame, wi);
    }
    if (wo.z < 0.0f) {
        wo.z = -wo.z;
        wi.z = -wi.z;
    }
    if (lobe.kind == LobeKind::sheen_reflection)
        return wi.z > 0.0f ? S(sheen_value(lobe.alpha_x, wo, wi)) : S(0.0f);
    if (lobe.kind == LobeKind::diffuse_reflection || lobe.kind == LobeKind::diffuse_transmission) {
        const auto cos_i = abs(wi.z);
        if (!(lobe.border_eta > 0)) return S(cos_i);
        return S((1 - border_reflectance(lobe, wo.z)) * (1 - border_reflectance(lobe, cos_i)) *
                 cos_i);
    }
    const Ggx ggx{lobe.alpha_x, lobe.alpha_y};
    const bool passes_pane = lobe.is_pane && lobe.kind == LobeKind::glossy_transmission;
    if (passes_pane) wi.z = -wi.z;
    const bool reflects = lobe.kind == LobeKind::glossy_reflection || passes_pane;
    const auto half = wo + (reflects ? 1.0f : lobe.eta) * wi;
    const S half_length2 = dot(half, half);
    if (!(half_length2 > 0.0f) || reflects != (wi.z > 0.0f)) return S(0.0f);
    const S side = half.z < 0.0f ? S(-1 / sqrt(half_length2)) : S(1 / sqrt(half_length2));
    const S cos_o = dot(wo, half) * side, cos_i = dot(wi, half) * side;
    if (!(cos_o > 0.0f) || reflects != (cos_i > 0.0f)) return S(0.0f);
    const S fresnel = border_reflectance(lobe, cos_o);
    const S d = ggx.d_along(half, half_length2);
    if (reflects)
        return S(0.25f * (passes_pane ? 1 - fresnel : fresnel) * d * ggx.g2_over_cos_o(wo, wi));
    I mirrored = wi;
    mirrored.z = -wi.z;
    return S((1 - fresnel) * d * ggx.g2_over_cos_o(wo, mirrored) * cos_o * -cos_i / half_length2);
}

}  // namespace covtrace
