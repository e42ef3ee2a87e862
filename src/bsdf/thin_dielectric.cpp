/// A pane without thickness. Light that passes both faces goes straight on, or, of a rough pane,
/// leaves as a lobe of GGX microfacets that is mirrored to the other side, as
/// KHR_materials_transmission has it: the facets spread it as they spread what they reflect.
///
/// A facet reflects the sum of what goes to and fro between both faces, R + (1 - R)^2 R + ... =
/// 2R/(1 + R), with R Fresnel's reflectance of one face, and lets all else pass; one of the faces
/// may have a film. Samples choose by the mean of the channels.
#include "bsdf/fresnel.h"
#include "bsdf/ggx.h"
#include "bsdf/models.h"
#include "bsdf/multiple_scattering.h"
#include "bsdf/thin_film.h"

namespace covtrace {
namespace {

/// The share of the light with the cosine `cosine` to a facet that both faces reflect together, the
/// same from either side.
ReflectedShare reflected_share(const ThinDielectricBsdf& b, float cosine) {
    const float r = fresnel_dielectric(cosine, b.eta).reflectance;
    if (!(b.film.weight > 0)) {
        const float both = 2 * r / (1 + r);
        return {Rgb(both), both};
    }
    if (r >= 1) return {Rgb(1), 1};
    const Rgb covered = under_film(b.film, cosine, Rgb(sqr((b.eta - 1) / (b.eta + 1))), Rgb(r));
    const Rgb through = Rgb(1) - covered;
    const Rgb both = covered + through * through * r / (Rgb(1) - covered * r);
    return {both, (both.r + both.g + both.b) / 3};
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
    const auto [share, chance] = reflected_share(b, dot(wo, m));
    return {(reflects ? share : b.transmittance * (Rgb(1) - share)) *
                (gain(b, wo.z) * 0.25f * ggx.d(m) * ggx.g2_over_cos_o(wo, wi)),
            (reflects ? chance : 1 - chance) * ggx.reflection_pdf(wo, m)};
}

Rgb eval(const ThinDielectricBsdf& b, Vec3 wo, Vec3 wi) {
    return eval_and_pdf(b, wo, wi).f;
}

float pdf(const ThinDielectricBsdf& b, Vec3 wo, Vec3 wi) {
    return eval_and_pdf(b, wo, wi).pdf;
}

std::optional<BsdfSample> sample(const ThinDielectricBsdf& b, Vec3 wo, float u_lobe, Vec2 u) {
    if (is_specular(b)) {
        const auto [share, chance] = reflected_share(b, std::abs(wo.z));
        if (u_lobe < chance)
            return BsdfSample{
                {-wo.x, -wo.y, wo.z}, share / Rgb(chance), chance, LobeKind::specular_reflection};
        return BsdfSample{-wo, b.transmittance * ((Rgb(1) - share) / Rgb(1 - chance)), 1 - chance,
                          LobeKind::specular_transmission};
    }
    const bool below = wo.z < 0;
    wo = to_upper_side(wo);
    const Ggx ggx{b.alpha_x, b.alpha_y};
    const Vec3 m = ggx.sample_visible_normal(wo, u);
    const float cos_m = dot(wo, m);
    if (!(cos_m > 0)) return {};
    const Vec3 wi = normalize(m * (2 * cos_m) - wo);
    if (!(wi.z > 0)) return {};
    const auto [share, chance] = reflected_share(b, cos_m);
    const bool reflects = u_lobe < chance;
    return BsdfSample{
        reflects == below ? mirror_z(wi) : wi,
        (reflects ? share / Rgb(chance) : b.transmittance * ((Rgb(1) - share) / Rgb(1 - chance))) *
            (gain(b, wo.z) * ggx.g2_over_g1(wo, wi)),
        (reflects ? chance : 1 - chance) * ggx.reflection_pdf(wo, m),
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
