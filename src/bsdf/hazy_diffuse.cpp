/// A Lambertian base under a dielectric coat, where the gap between them scatters: the walk of
/// coated_walk.h. Without scattering the model has a closed form, that of coat_table.h.
#include "bsdf/coated_walk.h"
#include "bsdf/fresnel.h"
#include "core/warp.h"

namespace covtrace {
namespace {

CoatLayers<DiffuseBsdf> layers(const HazyDiffuseBsdf& b) {
    static constexpr DiffuseBsdf kWhite{Rgb(1)};
    const bool is_in_spectrum = b.gap.spectrum && b.gap.spectrum->has_base;
    return {b.coat, is_in_spectrum ? kWhite : b.base, b.thickness, b.gap};
}

Rgb eval_coat(const HazyDiffuseBsdf& b, Vec3 wo, Vec3 wi) {
    return is_specular(b.coat) ? Rgb(0) : Rgb(eval(b.coat, wo, wi).r);
}

Rgb eval_base(const HazyDiffuseBsdf& b, Vec3 wo, Vec3 wi) {
    const auto one = [&](Vec3 o, Vec3 i, Rng& rng) { return CoatWalk(layers(b), o, i, rng).run(); };
    const CoatWalkSum sum = mean_of_walks(wo, wi, true, b.place, b.samples, one);
    return sum.straight + sum.scattered;
}

}  // namespace

Rgb eval(const HazyDiffuseBsdf& b, Vec3 wo, Vec3 wi) {
    if (!same_side(wo, wi)) return {};
    wo = to_upper_side(wo);
    wi = to_upper_side(wi);
    return eval_coat(b, wo, wi) + eval_base(b, wo, wi);
}

float pdf(const HazyDiffuseBsdf& b, Vec3 wo, Vec3 wi) {
    if (!same_side(wo, wi)) return 0;
    wo = to_upper_side(wo);
    wi = to_upper_side(wi);
    const float reflected = fresnel_dielectric(wo.z, b.coat.eta).reflectance;
    const float coat =
        is_specular(b.coat) ? 0 : ggx_of(b.coat).reflection_pdf(wo, normalize(wo + wi)) * reflected;
    return coat + (1 - reflected) * cosine_hemisphere_pdf(wi.z);
}

std::optional<BsdfSample> sample(const HazyDiffuseBsdf& b, Vec3 wo, float u_lobe, Vec2 u) {
    const Vec3 upper = to_upper_side(wo);
    auto s = sample(b.coat, upper, u_lobe, u);
    if (!s) return {};
    if (is_transmission(s->lobe)) {
        Rng rng = walk_numbers(upper, u_lobe, u);
        const auto exit = follow_to_exit(layers(b), s->wi, s->weight, rng);
        if (!exit) return {};
        s = BsdfSample{exit->wi, exit->weight, 0, LobeKind::diffuse_reflection};
    }
    if (!is_specular(s->lobe)) s->pdf = pdf(b, upper, s->wi);
    if (!(s->pdf > 0)) return {};
    if (wo.z < 0) s->wi = mirror_z(s->wi);
    return s;
}

// The parts are computed anew, not from the value that the caller gives, which may be the random
// weight of `sample` times its density.
LobeShares lobe_shares(const HazyDiffuseBsdf& b, Vec3 wo, Vec3 wi, Rgb) {
    if (!same_side(wo, wi)) return {};
    wo = to_upper_side(wo);
    wi = to_upper_side(wi);
    LobeShares shares{
        {LobeShare{LobeKind::diffuse_reflection, eval_base(b, wo, wi), 0, 0, 1, b.coat.eta}}, 1};
    if (is_specular(b.coat)) return shares;
    shares.lobes[1] = {LobeKind::glossy_reflection,
                       eval_coat(b, wo, wi),
                       b.coat.alpha_x,
                       b.coat.alpha_y,
                       1,
                       b.coat.eta};
    shares.count = 2;
    return shares;
}

Rgb albedo(const HazyDiffuseBsdf& b, Vec3 wo) {
    const DielectricFresnel f = fresnel_dielectric(std::abs(wo.z), b.coat.eta);
    if (f.cos_t == 0) return Rgb(1);
    // Between a thin gap, which shows the base, and a thick one, of which half of what is scattered
    // once goes up.
    const float clear = std::exp(-2 * b.thickness / f.cos_t);
    const Rgb below = clear * b.base.reflectance + (0.5f * (1 - clear)) * b.gap.albedo;
    return Rgb(f.reflectance) + (1 - f.reflectance) * below;
}

}  // namespace covtrace
