/// The border of a body that scatters light inside, met from outside and from below.
///
/// From outside a share of the light is reflected (the coat of the border) and all else enters.
/// From below light leaves by
///
///     f(wi) = T(wi) / (pi mean T),   T the share of light along wi that the border lets in,
///
/// as Jensen, Marschner, Levoy and Hanrahan 2001, "A practical model for subsurface light
/// transport", have it, normalised; of a border that does not refract, T = 1.
#include "bsdf/fresnel.h"
#include "bsdf/ggx.h"
#include "bsdf/models.h"
#include "core/warp.h"

namespace covtrace {

namespace {

CoatedDiffuseBsdf coat_of(const SubsurfaceBsdf& b) {
    CoatedDiffuseBsdf coat = b.border;
    coat.base = {};
    return coat;
}

/// Share of light along w that the border reflects.
float reflected_share(const CoatedDiffuseBsdf& coat, Vec3 w) {
    return max_component(albedo(coat, w));
}

/// Probability of sampling the coat: its share of the light that comes from the body and its
/// border.
float coat_probability(const SubsurfaceBsdf& b, Vec3 wo) {
    const float coat = reflected_share(coat_of(b), wo);
    const float body = (1 - coat) * max_component(b.border.reflectance);
    return coat + body > 0 ? coat / (coat + body) : 0;
}

/// Whether light that leaves comes from wo below and goes to wi above.
bool leaves(const SubsurfaceBsdf& b, Vec3 wo, Vec3 wi) {
    return b.is_left && wo.z * wi.z < 0;
}

Rgb eval_leaving(const SubsurfaceBsdf& b, Vec3 wi) {
    const float passes =
        b.refracts ? (1 - reflected_share(coat_of(b), wi)) / b.border.mean_transmission : 1;
    return Rgb(passes * cosine_hemisphere_pdf(std::abs(wi.z)));
}

/// The direction in which light from wo goes on inside; `u_kind` chooses whether it is refracted.
Vec3 sample_entering(const SubsurfaceBsdf& b, Vec3 wo, float u_kind, Vec2 u) {
    if (u_kind < b.refracted_share) {
        const Vec3 above{wo.x, wo.y, std::abs(wo.z)};
        const Ggx facets{b.facet_alpha_x, b.facet_alpha_y};
        const bool is_smooth = b.facet_alpha_x == 0 && b.facet_alpha_y == 0;
        const Vec3 m = is_smooth ? Vec3{0, 0, 1} : facets.sample_visible_normal(above, u);
        const float cos_i = dot(above, m), cos_t = fresnel_dielectric(cos_i, b.facet_eta).cos_t;
        const Vec3 wi = normalize(m * (cos_i / b.facet_eta - cos_t) - above / b.facet_eta);
        if (cos_t > 0 && wi.z < 0) return wo.z > 0 ? wi : mirror_z(wi);
    }
    return sample_cosine(wo, true, u);
}

}  // namespace

Rgb eval(const SubsurfaceBsdf& b, Vec3 wo, Vec3 wi) {
    if (b.is_left) return leaves(b, wo, wi) ? eval_leaving(b, wi) : Rgb(0);
    return eval(coat_of(b), wo, wi);
}

float pdf(const SubsurfaceBsdf& b, Vec3 wo, Vec3 wi) {
    if (b.is_left) return leaves(b, wo, wi) ? cosine_hemisphere_pdf(std::abs(wi.z)) : 0;
    return coat_probability(b, wo) * pdf(coat_of(b), wo, wi);
}

std::optional<BsdfSample> sample(const SubsurfaceBsdf& b, Vec3 wo, float u_lobe, Vec2 u) {
    if (b.is_left) {
        const Vec3 wi = sample_cosine(wo, true, u);
        const float density = cosine_hemisphere_pdf(std::abs(wi.z));
        if (!(density > 0)) return {};
        return BsdfSample{wi, eval_leaving(b, wi) / density, density,
                          LobeKind::diffuse_transmission};
    }
    const CoatedDiffuseBsdf coat = coat_of(b);
    const float by_coat = coat_probability(b, wo);
    if (u_lobe < by_coat) {
        auto s = sample(coat, wo, u_lobe / by_coat, u);
        if (!s) return s;
        s->weight *= 1 / by_coat;
        s->pdf *= by_coat;
        return s;
    }
    if (!(by_coat < 1) || is_black(b.border.reflectance)) return {};
    const float u_kind = (u_lobe - by_coat) / (1 - by_coat);
    const Vec3 wi = sample_entering(b, wo, u_kind, u);
    if (wi.z == 0) return {};
    return BsdfSample{wi, Rgb((1 - reflected_share(coat, wo)) / (1 - by_coat)), 1 - by_coat,
                      LobeKind::specular_transmission};
}

LobeShares lobe_shares(const SubsurfaceBsdf& b, Vec3 wo, Vec3 wi, Rgb value) {
    if (b.is_left && !leaves(b, wo, wi)) return {};
    if (b.is_left)
        return {{LobeShare{LobeKind::diffuse_transmission, value, 0, 0, 1,
                           b.refracts ? b.border.eta : 0}},
                1};
    LobeShares shares = lobe_shares(coat_of(b), wo, wi, value);
    if (shares.count < 2) return {};
    shares.lobes[0] = shares.lobes[1];  // the coat's, without its black base
    shares.count = 1;
    return shares;
}

bool is_specular(const SubsurfaceBsdf& b) {
    return !b.is_left && (b.border.eta == 1 || (b.border.alpha_x == 0 && b.border.alpha_y == 0));
}

Rgb albedo(const SubsurfaceBsdf& b, Vec3 wo) {
    return b.is_left ? Rgb(1) : albedo(b.border, wo);
}

}  // namespace covtrace
