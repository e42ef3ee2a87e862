/// Sheen of upright fibres, as glTF's KHR_materials_sheen has it.
///
/// The distribution of normals is the exponentiated sine ("Charlie"), the masking a fit to it, both
/// of Conty Estevez and Kulla 2017, "Production Friendly Microfacet Sheen BRDF":
///
///    D = (2 + 1/alpha) sin(theta_h)^(1/alpha) / (2 pi)
///    f = D / ((1 + Lambda(wo) + Lambda(wi)) 4 cos(wo) cos(wi))
///
/// The fit of Lambda reflects more than all light of grazing directions (cosines below 0.05) where
/// alpha is below 0.05; there f is divided by the larger of both directions' albedos.
#pragma once

#include <array>
#include <cmath>

#include "core/vec.h"

namespace covtrace {

/// The fitted curve that log Lambda follows up to the cosine 0.5, for any scalar type.
template <typename S>
S sheen_curve(const S& cosine, float alpha) {
    using std::pow;
    const float t = (1 - alpha) * (1 - alpha);
    const auto mix = [t](float rough, float fine) { return rough + (fine - rough) * t; };
    const float a = mix(21.5473f, 25.3245f), b = mix(3.82987f, 3.32435f),
                c = mix(0.19823f, 0.16801f), d = mix(-1.97760f, -1.27393f),
                e = mix(-4.32054f, -4.85967f);
    constexpr float kLeast = 1e-7f;  // the power has no derivative at 0
    const S x = cosine > kLeast ? cosine : S(kLeast);
    return S(a / (1 + b * S(pow(x, c))) + d * x + e);
}

template <typename S>
S sheen_lambda(const S& cosine, float alpha) {
    using std::exp;
    if (cosine < 0.5f) return S(exp(sheen_curve(cosine, alpha)));
    return S(exp(2 * sheen_curve(0.5f, alpha) - sheen_curve(S(1 - cosine), alpha)));
}

/// The BRDF f times cos(wi), for unit vectors with z > 0 of any scalar types.
template <typename O, typename I>
auto sheen_value(float alpha, const O& wo, const I& wi) {
    using std::pow;
    using S = std::decay_t<decltype(wo.x + wi.x)>;
    const auto half = wo + wi;
    const S sine2 = S((half.x * half.x + half.y * half.y) / dot(half, half));
    constexpr float kLeast = 1e-12f;  // the power has no derivative at 0
    const S x = sine2 > kLeast ? sine2 : S(kLeast);
    const S d = S((2 + 1 / alpha) * (kInvPi / 2) * S(pow(x, 0.5f / alpha)));
    // The fit of Lambda ends before it would outweigh the cosine.
    constexpr float kGrazing = 1e-4f;
    const auto above = [](const auto& c) {
        return c > kGrazing ? c : std::decay_t<decltype(c)>(kGrazing);
    };
    const auto cos_o = above(wo.z);
    const auto cos_i = above(wi.z);
    return S(d / (4 * cos_o * (1 + sheen_lambda(cos_o, alpha) + sheen_lambda(cos_i, alpha))));
}

/// Directional albedo of the sheen over alpha and angle.
class SheenTable {
  public:
    /// Narrowest distribution; narrower ones are rendered with this one, as they shine at cosines
    /// below 0.1 alone.
    static constexpr float kLeastAlpha = 0.005f;

    /// Fills the table by quadrature; takes about 0.1 s.
    SheenTable();
    /// Share of the light from a direction with cosine `cos_theta` > 0 that f reflects; above 1
    /// where the fit does. `alpha` in [kLeastAlpha, 1].
    float albedo(float alpha, float cos_theta) const;

  private:
    static constexpr int kRows = 32;   ///< over sqrt(alpha) from kLeastAlpha to 1
    static constexpr int kNodes = 64;  ///< over sqrt(cos) in [0, 1]
    std::array<std::array<float, kNodes>, kRows> albedo_;
};

}  // namespace covtrace
