/// The border of a clear dielectric: reflection and refraction by a smooth surface or by GGX
/// microfacets (Walter et al. 2007, "Microfacet models for refraction through rough surfaces").
/// Reflection is chosen with the probability of Fresnel's reflectance, under a film of the mean of
/// its channels.
///
/// Everything is computed as seen from wo's side: wo.z > 0 and eta = index of the far side over
/// that of wo's side.
#include "bsdf/fresnel.h"
#include "bsdf/ggx.h"
#include "bsdf/models.h"
#include "bsdf/multiple_scattering.h"

namespace covtrace {
namespace {

/// A pair as seen from wo's side, with the microfacet that connects it.
struct Microfacet {
    Vec3 wo, wi;
    float eta = 1;
    bool reflects = true;
    Vec3 m;
    ReflectedShare reflected;
    float half_length2 = 0;  ///< |eta wi + wo|^2, for refraction
};

/// The share that facets reflect of light with the cosine `cos_o` to them on wo's side; `f`: their
/// reflectance and the refracted cosine, without a film.
ReflectedShare reflected_share(const DielectricBsdf& b, bool below, float cos_o,
                               const DielectricFresnel& f) {
    return reflected_share(b.film, below ? f.cos_t : cos_o, sqr((b.eta - 1) / (b.eta + 1)),
                           f.reflectance);
}

/// The microfacet that connects a pair; empty where none does.
std::optional<Microfacet> connect(const DielectricBsdf& b, Vec3 wo, Vec3 wi) {
    if (wo.z * wi.z == 0 || is_specular(b)) return {};
    Microfacet f;
    f.eta = wo.z > 0 ? b.eta : 1 / b.eta;
    f.wo = wo.z > 0 ? wo : mirror_z(wo);
    f.wi = wo.z > 0 ? wi : mirror_z(wi);
    f.reflects = f.wi.z > 0;
    const Vec3 half = f.reflects ? f.wo + f.wi : f.wo + f.wi * f.eta;
    f.half_length2 = length_squared(half);
    if (!(f.half_length2 > 0)) return {};
    f.m = half / std::copysign(std::sqrt(f.half_length2), half.z);
    const float cos_o = dot(f.wo, f.m), cos_i = dot(f.wi, f.m);
    if (!(cos_o > 0) || !(f.reflects ? cos_i > 0 : cos_i < 0)) return {};
    f.reflected = reflected_share(b, wo.z < 0, cos_o, fresnel_dielectric(cos_o, f.eta));
    return f;
}

}  // namespace

bool is_specular(const DielectricBsdf& b) {
    return b.eta == 1 || (b.alpha_x == 0 && b.alpha_y == 0);
}

Rgb eval(const DielectricBsdf& b, Vec3 wo, Vec3 wi) {
    const std::optional<Microfacet> f = connect(b, wo, wi);
    if (!f) return {};
    const Ggx ggx{b.alpha_x, b.alpha_y};
    const Rgb d_g =
        gain(b, wo) * ggx.d(f->m) * ggx.g2_over_cos_o(f->wo, f->reflects ? f->wi : mirror_z(f->wi));
    if (f->reflects) return 0.25f * f->reflected.share * d_g;
    // Refraction is equation 21 of Walter et al. 2007, with |eta wi + wo|^2 for the denominator and
    // its 1 / eta^2 for radiance.
    return b.transmittance * ((Rgb(1) - f->reflected.share) * d_g *
                              std::abs(dot(f->wo, f->m) * dot(f->wi, f->m)) / Rgb(f->half_length2));
}

float pdf(const DielectricBsdf& b, Vec3 wo, Vec3 wi) {
    const std::optional<Microfacet> f = connect(b, wo, wi);
    if (!f) return 0;
    const Ggx ggx{b.alpha_x, b.alpha_y};
    if (f->reflects) return f->reflected.chance * ggx.reflection_pdf(f->wo, f->m);
    return (1 - f->reflected.chance) * ggx.visible_normal_pdf(f->wo, f->m) * sqr(f->eta) *
           std::abs(dot(f->wi, f->m)) / f->half_length2;
}

std::optional<BsdfSample> sample(const DielectricBsdf& b, Vec3 wo, float u_lobe, Vec2 u) {
    const bool below = wo.z < 0;
    const Rgb scale = is_specular(b) ? Rgb(1) : gain(b, wo);
    if (below) wo = mirror_z(wo);
    const float eta = below ? 1 / b.eta : b.eta;

    if (is_specular(b)) {
        const DielectricFresnel f = fresnel_dielectric(wo.z, eta);
        const auto [share, chance] = reflected_share(b, below, wo.z, f);
        if (u_lobe < chance) {
            const Vec3 wi{-wo.x, -wo.y, below ? -wo.z : wo.z};
            return BsdfSample{wi, share / Rgb(chance), chance, LobeKind::specular_reflection};
        }
        const Vec3 wi{-wo.x / eta, -wo.y / eta, below ? f.cos_t : -f.cos_t};
        return BsdfSample{wi, b.transmittance / sqr(eta) * ((Rgb(1) - share) / Rgb(1 - chance)),
                          1 - chance, LobeKind::specular_transmission, eta};
    }

    const Ggx ggx{b.alpha_x, b.alpha_y};
    const Vec3 m = ggx.sample_visible_normal(wo, u);
    const float cos_o = dot(wo, m);
    if (!(cos_o > 0)) return {};
    const DielectricFresnel f = fresnel_dielectric(cos_o, eta);
    const auto [share, chance] = reflected_share(b, below, cos_o, f);
    if (u_lobe < chance) {
        const Vec3 wi = normalize(m * (2 * cos_o) - wo);
        if (!(wi.z > 0)) return {};
        return BsdfSample{below ? mirror_z(wi) : wi,
                          share / Rgb(chance) * (scale * ggx.g2_over_g1(wo, wi)),
                          chance * ggx.reflection_pdf(wo, m), LobeKind::glossy_reflection};
    }
    const Vec3 wi = normalize(m * (cos_o / eta - f.cos_t) - wo / eta);
    if (!(wi.z < 0)) return {};
    // The half vector's length is |eta wi + wo| = eta cos_t - cos_o up to sign, both along m.
    const float half_length2 = sqr(eta * f.cos_t - cos_o);
    const float density =
        (1 - chance) * ggx.visible_normal_pdf(wo, m) * sqr(eta) * f.cos_t / half_length2;
    if (!(density > 0) || !std::isfinite(density)) return {};
    return BsdfSample{below ? mirror_z(wi) : wi,
                      b.transmittance * ((Rgb(1) - share) / Rgb(1 - chance)) *
                          (scale * ggx.g2_over_g1(wo, mirror_z(wi)) / Rgb(sqr(eta))),
                      density, LobeKind::glossy_transmission, eta};
}

LobeShares lobe_shares(const DielectricBsdf& b, Vec3 wo, Vec3 wi, Rgb value) {
    if (is_black(value)) return {};
    const float eta = wo.z > 0 ? b.eta : 1 / b.eta;
    if (same_side(wo, wi))
        return {{LobeShare{LobeKind::glossy_reflection, value, b.alpha_x, b.alpha_y, 1, eta}}, 1};
    return {{LobeShare{LobeKind::glossy_transmission, value, b.alpha_x, b.alpha_y, eta, eta}}, 1};
}

}  // namespace covtrace
