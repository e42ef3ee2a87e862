/// A metal: reflection by GGX microfacets with the Fresnel reflectance of a complex index, one per
/// colour channel.
#include "bsdf/fresnel.h"
#include "bsdf/ggx.h"
#include "bsdf/models.h"
#include "bsdf/multiple_scattering.h"

namespace covtrace {
namespace {

bool is_smooth(const ConductorBsdf& b) {
    return b.alpha_x == 0 && b.alpha_y == 0;
}
Vec3 to_upper_side(Vec3 w) {
    return {w.x, w.y, std::abs(w.z)};
}

}  // namespace

BsdfValue eval_and_pdf(const ConductorBsdf& b, Vec3 wo, Vec3 wi) {
    if (is_smooth(b) || !same_side(wo, wi)) return {};
    wo = to_upper_side(wo);
    wi = to_upper_side(wi);
    const Ggx ggx{b.alpha_x, b.alpha_y};
    const Vec3 m = normalize(wo + wi);
    return {gain(b, wo.z) * fresnel_conductor(dot(wo, m), b.eta, b.k) *
                (0.25f * ggx.d(m) * ggx.g2_over_cos_o(wo, wi)),
            ggx.reflection_pdf(wo, m)};
}

Rgb eval(const ConductorBsdf& b, Vec3 wo, Vec3 wi) {
    return eval_and_pdf(b, wo, wi).f;
}

float pdf(const ConductorBsdf& b, Vec3 wo, Vec3 wi) {
    return eval_and_pdf(b, wo, wi).pdf;
}

std::optional<BsdfSample> sample(const ConductorBsdf& b, Vec3 wo, float, Vec2 u) {
    if (is_smooth(b))
        return BsdfSample{{-wo.x, -wo.y, wo.z},
                          fresnel_conductor(std::abs(wo.z), b.eta, b.k),
                          1,
                          LobeKind::specular_reflection};
    const bool below = wo.z < 0;
    wo = to_upper_side(wo);
    const Ggx ggx{b.alpha_x, b.alpha_y};
    const Vec3 m = ggx.sample_visible_normal(wo, u);
    const float cos_m = dot(wo, m);
    if (!(cos_m > 0)) return {};
    const Vec3 wi = normalize(m * (2 * cos_m) - wo);
    if (!(wi.z > 0)) return {};
    return BsdfSample{below ? mirror_z(wi) : wi,
                      gain(b, wo.z) * fresnel_conductor(cos_m, b.eta, b.k) * ggx.g2_over_g1(wo, wi),
                      ggx.reflection_pdf(wo, m), LobeKind::glossy_reflection};
}

LobeShares lobe_shares(const ConductorBsdf& b, Vec3 wo, Vec3 wi, Rgb value) {
    if (is_smooth(b) || !same_side(wo, wi)) return {};
    return {{LobeShare{LobeKind::glossy_reflection, value, b.alpha_x, b.alpha_y, 1,
                       luminance(b.eta), luminance(b.k)}},
            1};
}

Rgb albedo(const ConductorBsdf& b, Vec3 wo) {
    return fresnel_conductor(std::abs(wo.z), b.eta, b.k);
}

}  // namespace covtrace
