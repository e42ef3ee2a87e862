/// A pane without thickness. Light that passes both faces goes straight on, or, of a rough pane,
/// leaves as a lobe of GGX microfacets that is mirrored to the other side, as
/// KHR_materials_transmission has it: the facets spread it as they spread what they reflect.
///
/// A facet reflects the sum of what goes to and fro between both faces, R + (1 - R)^2 R + ... =
/// 2R/(1 + R), with R Fresnel's reflectance of one face, and lets all else pass.
#include "bsdf/fresnel.h"
#include "bsdf/ggx.h"
#include "bsdf/models.h"
#include "bsdf/multiple_scattering.h"

namespace covtrace {
namespace {

float reflectance_of_faces(const ThinDielectricBsdf& b, float cos_i) {
    const float r = fresnel_dielectric(cos_i, b.eta).reflectance;
    return 2 * r / (1 + r);
}
Vec3 to_upper_side(Vec3 w) {
    return {w.x, w.y, std::abs(w.z)};
}

}  // namespace

bool is_specular(const ThinDielectricBsdf& b) {
    return b.alpha_x == 0 && b.alpha_y == 0;
}

BsdfValue eval_and_pdf(const ThinDielectricBsdf& b, Vec3 wo, Vec3 wi) {
    if (is_specular(b) || wo.z * wi.z == 0) return {};
    const bool reflects = same_side(wo, wi);
    wo = to_upper_side(wo);
    wi = to_upper_side(wi);
    const Ggx ggx{b.alpha_x, b.alpha_y};
    const Vec3 m = normalize(wo + wi);
    const float reflected = reflectance_of_faces(b, dot(wo, m));
    const float share = reflects ? reflected : 1 - reflected;
    return {(gain(b, wo.z) * share * 0.25f * ggx.d(m) * ggx.g2_over_cos_o(wo, wi)) *
                (reflects ? Rgb(1) : b.transmittance),
            share * ggx.reflection_pdf(wo, m)};
}

Rgb eval(const ThinDielectricBsdf& b, Vec3 wo, Vec3 wi) {
    return eval_and_pdf(b, wo, wi).f;
}

float pdf(const ThinDielectricBsdf& b, Vec3 wo, Vec3 wi) {
    return eval_and_pdf(b, wo, wi).pdf;
}

std::optional<BsdfSample> sample(const ThinDielectricBsdf& b, Vec3 wo, float u_lobe, Vec2 u) {
    if (is_specular(b)) {
        const float reflected = reflectance_of_faces(b, std::abs(wo.z));
        if (u_lobe < reflected)
            return BsdfSample{
                {-wo.x, -wo.y, wo.z}, Rgb(1), reflected, LobeKind::specular_reflection};
        return BsdfSample{-wo, b.transmittance, 1 - reflected, LobeKind::specular_transmission};
    }
    const bool below = wo.z < 0;
    wo = to_upper_side(wo);
    const Ggx ggx{b.alpha_x, b.alpha_y};
    const Vec3 m = ggx.sample_visible_normal(wo, u);
    const float cos_m = dot(wo, m);
    if (!(cos_m > 0)) return {};
    const Vec3 wi = normalize(m * (2 * cos_m) - wo);
    if (!(wi.z > 0)) return {};
    const float reflected = reflectance_of_faces(b, cos_m);
    const bool reflects = u_lobe < reflected;
    return BsdfSample{
        reflects == below ? mirror_z(wi) : wi,
        (gain(b, wo.z) * ggx.g2_over_g1(wo, wi)) * (reflects ? Rgb(1) : b.transmittance),
        (reflects ? reflected : 1 - reflected) * ggx.reflection_pdf(wo, m),
        reflects ? LobeKind::glossy_reflection : LobeKind::glossy_transmission};
}

LobeShares lobe_shares(const ThinDielectricBsdf& b, Vec3 wo, Vec3 wi, Rgb value) {
    if (is_specular(b) || wo.z * wi.z == 0) return {};
    LobeShare lobe{same_side(wo, wi) ? LobeKind::glossy_reflection : LobeKind::glossy_transmission,
                   value,
                   b.alpha_x,
                   b.alpha_y,
                   1,
                   b.eta};
    lobe.is_pane = true;
    return {{lobe}, 1};
}

Rgb albedo(const ThinDielectricBsdf& b, Vec3) {
    return b.transmittance;
}

}  // namespace covtrace
