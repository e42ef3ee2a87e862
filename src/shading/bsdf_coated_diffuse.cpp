/// A Lambertian base under a dielectric coat; the model is derived in coat_table.h.
#include "core/warp.h"
#include "shading/bsdf_models.h"
#include "shading/coat_table.h"
#include "shading/fresnel.h"
#include "shading/ggx.h"

namespace covtrace {
namespace {

bool is_smooth(const CoatedDiffuseBsdf& b) {
    return b.eta == 1 || (b.alpha_x == 0 && b.alpha_y == 0);
}

Vec3 to_upper_side(Vec3 w) {
    return {w.x, w.y, std::abs(w.z)};
}

/// Where the tables hold the coat's roughness towards w.
float table_row(const CoatedDiffuseBsdf& b, Vec3 w) {
    if (b.alpha_x == b.alpha_y) return b.table_row;
    const float x2 = sqr(b.alpha_x), y2 = sqr(b.alpha_y);
    return CoatTable::row_of(
        std::sqrt(x2 * sqr(w.x) + y2 * sqr(w.y) + 0.5f * (x2 + y2) * sqr(w.z)));
}

float coat_albedo(const CoatedDiffuseBsdf& b, Vec3 wo) {
    return is_smooth(b) ? fresnel_dielectric(wo.z, b.eta).reflectance
                        : b.table->reflection(table_row(b, wo), wo.z);
}

/// T of coat_table.h, or 1 - E, for w.z > 0 as in the rest of these helpers.
float transmission(const CoatedDiffuseBsdf& b, Vec3 w) {
    if (b.is_total) return 1 - coat_albedo(b, w);
    if (!is_smooth(b)) return b.table->transmission(table_row(b, w), w.z);
    const DielectricFresnel f = fresnel_dielectric(w.z, b.eta);
    if (f.cos_t == 0) return 0;
    return (1 - f.reflectance) * std::exp(-b.table->thickness() / f.cos_t);
}

float mean_transmission(const CoatedDiffuseBsdf& b) {
    return b.is_total ? 1 - b.table->mean_reflection(b.table_row)
                      : b.table->mean_transmission(b.table_row);
}

Rgb eval_base(const CoatedDiffuseBsdf& b, Vec3 wo, Vec3 wi) {
    return b.base * (transmission(b, wo) * transmission(b, wi) * wi.z);
}

float eval_coat(const CoatedDiffuseBsdf& b, Vec3 wo, Vec3 wi) {
    if (is_smooth(b)) return 0;
    const Ggx ggx{b.alpha_x, b.alpha_y};
    const Vec3 m = normalize(wo + wi);
    return 0.25f * fresnel_dielectric(dot(wo, m), b.eta).reflectance * ggx.d(m) *
           ggx.g2_over_cos_o(wo, wi);
}

Rgb base_albedo(const CoatedDiffuseBsdf& b, Vec3 wo) {
    return b.base * (kPi * transmission(b, wo) * mean_transmission(b));
}

/// Probability of sampling the coat: its share of the reflected energy. Below 0 where nothing is
/// reflected.
float coat_probability(const CoatedDiffuseBsdf& b, Vec3 wo) {
    const float coat = coat_albedo(b, wo), base = max_component(base_albedo(b, wo));
    return coat + base > 0 ? coat / (coat + base) : -1;
}

float mixture_pdf(const CoatedDiffuseBsdf& b, float choose_coat, Vec3 wo, Vec3 wi) {
    const float base = (1 - choose_coat) * cosine_hemisphere_pdf(wi.z);
    if (is_smooth(b)) return base;
    return base + choose_coat * Ggx{b.alpha_x, b.alpha_y}.reflection_pdf(wo, normalize(wo + wi));
}

}  // namespace

Rgb eval(const CoatedDiffuseBsdf& b, Vec3 wo, Vec3 wi) {
    if (!same_side(wo, wi)) return {};
    wo = to_upper_side(wo);
    wi = to_upper_side(wi);
    return Rgb(eval_coat(b, wo, wi)) + eval_base(b, wo, wi);
}

float pdf(const CoatedDiffuseBsdf& b, Vec3 wo, Vec3 wi) {
    if (!same_side(wo, wi)) return 0;
    wo = to_upper_side(wo);
    const float choose_coat = coat_probability(b, wo);
    return choose_coat < 0 ? 0 : mixture_pdf(b, choose_coat, wo, to_upper_side(wi));
}

std::optional<BsdfSample> sample(const CoatedDiffuseBsdf& b, Vec3 wo, float u_lobe, Vec2 u) {
    const bool below = wo.z < 0;
    wo = to_upper_side(wo);
    const float choose_coat = coat_probability(b, wo);
    if (choose_coat < 0) return {};

    const bool from_coat = u_lobe < choose_coat;
    Vec3 wi;
    if (!from_coat) {
        wi = square_to_cosine_hemisphere(u);
    } else if (is_smooth(b)) {
        const float f = fresnel_dielectric(wo.z, b.eta).reflectance;
        return BsdfSample{{-wo.x, -wo.y, below ? -wo.z : wo.z},
                          Rgb(f / choose_coat),
                          choose_coat,
                          LobeKind::specular_reflection};
    } else {
        const Vec3 m = Ggx{b.alpha_x, b.alpha_y}.sample_visible_normal(wo, u);
        wi = normalize(m * (2 * dot(wo, m)) - wo);
    }
    if (!(wi.z > 0)) return {};
    const float density = mixture_pdf(b, choose_coat, wo, wi);
    if (!(density > 0)) return {};
    const Rgb value = Rgb(eval_coat(b, wo, wi)) + eval_base(b, wo, wi);
    return BsdfSample{below ? mirror_z(wi) : wi, value / density, density,
                      from_coat ? LobeKind::glossy_reflection : LobeKind::diffuse_reflection};
}

LobeShares lobe_shares(const CoatedDiffuseBsdf& b, Vec3 wo, Vec3 wi) {
    if (!same_side(wo, wi)) return {};
    wo = to_upper_side(wo);
    wi = to_upper_side(wi);
    LobeShares shares{
        {LobeShare{LobeKind::diffuse_reflection, eval_base(b, wo, wi), 0, 0, 1, b.eta}}, 1};
    if (!is_smooth(b))
        shares.lobes[shares.count++] = {
            LobeKind::glossy_reflection, Rgb(eval_coat(b, wo, wi)), b.alpha_x, b.alpha_y, 1, b.eta};
    return shares;
}

Rgb albedo(const CoatedDiffuseBsdf& b, Vec3 wo) {
    wo = to_upper_side(wo);
    return Rgb(coat_albedo(b, wo)) + base_albedo(b, wo);
}

}  // namespace covtrace
