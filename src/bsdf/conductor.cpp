/// A metal: reflection by GGX microfacets with the Fresnel reflectance of a complex index, one per
/// colour channel, or with Schlick's in its place.
#include "bsdf/ggx.h"
#include "bsdf/models.h"
#include "bsdf/multiple_scattering.h"

namespace covtrace {
namespace {

bool is_smooth(const ConductorBsdf& b) {
    return b.alpha_x == 0 && b.alpha_y == 0;
}

}  // namespace

BsdfValue eval_and_pdf(const ConductorBsdf& b, Vec3 wo, Vec3 wi) {
    if (is_smooth(b) || !same_side(wo, wi)) return {};
    wo = to_upper_side(wo);
    wi = to_upper_side(wi);
    const Ggx ggx{b.alpha_x, b.alpha_y};
    const Vec3 m = normalize(wo + wi);
    return {
        gain(b, wo.z) * reflectance(b, dot(wo, m)) * (0.25f * ggx.d(m) * ggx.g2_over_cos_o(wo, wi)),
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
        return BsdfSample{
            {-wo.x, -wo.y, wo.z}, reflectance(b, std::abs(wo.z)), 1, LobeKind::specular_reflection};
    const bool below = wo.z < 0;
    wo = to_upper_side(wo);
    const Ggx ggx{b.alpha_x, b.alpha_y};
    const Vec3 m = ggx.sample_visible_normal(wo, u);
    const float cos_m = dot(wo, m);
    if (!(cos_m > 0)) return {};
    const Vec3 wi = normalize(m * (2 * cos_m) - wo);
    if (!(wi.z > 0)) return {};
    return BsdfSample{below ? mirror_z(wi) : wi,
                      gain(b, wo.z) * reflectance(b, cos_m) * ggx.g2_over_g1(wo, wi),
                      ggx.reflection_pdf(wo, m), LobeKind::glossy_reflection};
}

LobeShares lobe_shares(const ConductorBsdf& b, Vec3 wo, Vec3 wi, Rgb value) {
    if (is_smooth(b) || !same_side(wo, wi)) return {};
    LobeShare lobe{LobeKind::glossy_reflection, value, b.alpha_x, b.alpha_y, 1};
    if (b.schlick) {
        lobe.border_metal = {luminance(b.schlick->normal), luminance(b.schlick->grazing),
                             luminance(b.schlick->dip)};
    } else {
        lobe.border_eta = luminance(b.eta);
        lobe.border_k = luminance(b.k);
    }
    return {{lobe}, 1};
}

Rgb albedo(const ConductorBsdf& b, Vec3 wo) {
    return reflectance(b, std::abs(wo.z));
}

}  // namespace covtrace
