/// A metal under a dielectric coat: pbrt-v4's layered walk.
///
/// Light enters through the (rough) coat, is weakened by A(w) = exp(-thickness / |w.z|) at each
/// crossing of the gap, and goes to and fro between metal and coat until it leaves. With f_t the
/// coat's BTDF for radiance (inwards, with its 1 / eta^2) and f_t' the one outwards,
///
///   f(wo, wi) = f_coat(wo, wi) + integral f_t(wo, v) |v.z| A(v) g(v, v') |v'.z| A(v') f_t'(v',
///   wi),
///
/// g: all that happens between first and last meeting of the metal. There is no closed form. As in
/// pbrt, `eval` is one walk's estimate, with random numbers that are a hash of both directions, so
/// that a pair always gets the same value, and reciprocal: the pair is put into one order first,
/// but for metals that are not reciprocal themselves (multiple_scattering.h). Unlike pbrt's, the
/// hash has the place on the surface, too: where parallel light meets a plane in an orthographic
/// view all samples have the same directions, and would all have one walk's error. At each
/// reflection by the metal both directions through the coat are connected: wi's refracted one, and
/// the one in which the metal reflects, by multiple importance sampling (Veach 1997, "Robust Monte
/// Carlo methods for light transport simulation", chapter 9).
///
/// A smooth coat over a smooth metal is a mirror: the series is summed.
///
/// Where the gap scatters, the walk is that of coated_walk.h.
#include <array>
#include <bit>

#include "bsdf/coated_walk.h"
#include "bsdf/fresnel.h"
#include "core/warp.h"

namespace covtrace {
namespace {

bool is_smooth(const CoatedConductorBsdf& b) {
    return is_specular(b.coat);
}
bool is_metal_smooth(const CoatedConductorBsdf& b) {
    return b.metal.alpha_x == 0 && b.metal.alpha_y == 0;
}
float attenuation(const CoatedConductorBsdf& b, Vec3 w) {
    return std::exp(-b.thickness / std::abs(w.z));
}
/// Whether coat and metal are mirrors.
bool are_borders_smooth(const CoatedConductorBsdf& b) {
    return is_smooth(b) && is_metal_smooth(b);
}
CoatLayers<ConductorBsdf> layers(const CoatedConductorBsdf& b) {
    return {b.coat, b.metal, b.thickness, b.gap};
}

/// Estimate of f - f_coat by one random walk; both directions are outside, z > 0.
Rgb walk(const CoatedConductorBsdf& b, Vec3 wo, Vec3 wi, Rng& rng) {
    const auto first = enter_coat(b.coat, wo, rng.next_2d());
    const auto last = enter_coat(b.coat, wi, rng.next_2d());
    if (!first) return {};
    const bool smooth_coat = is_smooth(b), smooth_metal = is_metal_smooth(b);
    Rgb sum, beta(first->weight / sqr(b.coat.eta) * attenuation(b, first->w));
    Vec3 in = first->w;  // going down
    for (int bounce = 0;; ++bounce) {
        const Vec3 from = -in;  // direction as the metal sees it
        if (last && !smooth_metal) {
            const Vec3 to = -last->w;
            const float share =
                smooth_coat ? 1 : power_heuristic(last->pdf, pdf(b.metal, from, to));
            sum += beta * eval(b.metal, from, to) *
                   (share * last->weight * attenuation(b, last->w) / to.z);
        }
        const float u_lobe = rng.next_float();
        const auto s = sample(b.metal, from, u_lobe, rng.next_2d());
        if (!s) break;
        const Vec3 up = s->wi;
        beta *= s->weight * attenuation(b, up);
        const Vec3 below = -up;  // direction as the coat sees it
        if (!smooth_coat) {
            const float share =
                smooth_metal ? 1 : power_heuristic(s->pdf, enter_coat_pdf(b.coat, wi, below));
            sum += beta * eval(b.coat, below, wi) * (share / wi.z);
        }
        if (bounce + 1 >= b.bounces) break;
        const auto back = reflect_below_coat(b.coat, below, rng.next_2d());
        if (!back) break;
        in = back->w;
        beta *= back->weight * attenuation(b, in);
    }
    return sum;
}

float eval_coat(const CoatedConductorBsdf& b, Vec3 wo, Vec3 wi) {
    return is_smooth(b) ? 0 : eval(b.coat, wo, wi).r;
}

/// Light that the gap and the metal reflect.
CoatWalkSum eval_base(const CoatedConductorBsdf& b, Vec3 wo, Vec3 wi) {
    if (is_specular(b)) return {};
    const auto one = [&](Vec3 o, Vec3 i, Rng& rng) {
        return b.gap.scatters() ? CoatWalk(layers(b), o, i, rng).run()
                                : CoatWalkSum{walk(b, o, i, rng), {}};
    };
    return mean_of_walks(wo, wi, !b.metal.white, b.place, b.samples, one);
}

/// Reflectance of smooth borders, with all bounces together.
Rgb smooth_reflectance(const CoatedConductorBsdf& b, Vec3 wo) {
    const DielectricFresnel f = fresnel_dielectric(wo.z, b.coat.eta);
    if (f.cos_t == 0) return Rgb(1);
    const float twice = sqr(std::exp(-b.thickness / f.cos_t));
    const Rgb once = twice * reflectance(b.metal, f.cos_t);
    const Rgb ratio = f.reflectance * once;
    Rgb sum, power(1);
    for (int bounce = 0; bounce < b.bounces; ++bounce) {
        sum += power;
        power *= ratio;
    }
    return Rgb(f.reflectance) + sqr(1 - f.reflectance) * once * sum;
}

/// Share of the light that goes down the gap with the given cosine, and straight up again, which
/// is scattered on its way.
float scattered_share(const CoatedConductorBsdf& b, float cosine) {
    return b.gap.scatters() ? 1 - std::exp(-2 * b.thickness / cosine) : 0;
}

/// A metal alone whose roughness spreads light inside as far as metal and coat do together: a ray's
/// slope inside changes by 2 alpha at the metal and by (1 - 1 / eta) alpha at each crossing of the
/// coat.
ConductorBsdf effective_metal(const CoatedConductorBsdf& b) {
    const float crossing2 = 0.5f * sqr(1 - 1 / b.coat.eta);
    const auto joined = [crossing2](float metal, float coat) {
        return std::sqrt(sqr(metal) + crossing2 * sqr(coat));
    };
    ConductorBsdf m = b.metal;
    m.alpha_x = joined(m.alpha_x, b.coat.alpha_x);
    m.alpha_y = joined(m.alpha_y, b.coat.alpha_y);
    return m;
}

/// Samples a smooth coat over a smooth metal whose gap scatters. One choice has all of the mirror's
/// light; the other follows light into the gap, and is lost where it comes back unscattered.
std::optional<BsdfSample> sample_hazy_mirror(const CoatedConductorBsdf& b, Vec3 wo, float u_lobe,
                                             Vec2 u) {
    const Vec3 upper = to_upper_side(wo);
    const DielectricFresnel f = fresnel_dielectric(upper.z, b.coat.eta);
    const Rgb mirrored = smooth_reflectance(b, upper);
    const float scattered = (1 - f.reflectance) * scattered_share(b, f.cos_t);
    if (!(max_component(mirrored) + scattered > 0)) return {};
    const float choose_mirror = max_component(mirrored) / (max_component(mirrored) + scattered);
    if (u_lobe < choose_mirror || !(scattered > 0))
        return BsdfSample{{-wo.x, -wo.y, wo.z},
                          mirrored / choose_mirror,
                          choose_mirror,
                          LobeKind::specular_reflection};
    Rng rng = walk_numbers(upper, u_lobe, u);
    const auto in = enter_coat(b.coat, upper, u);
    if (!in) return {};
    const Rgb weight(in->weight / (1 - choose_mirror) / sqr(b.coat.eta));
    const auto exit = follow_to_exit(layers(b), in->w, weight, rng);
    if (!exit || !exit->is_scattered) return {};
    return BsdfSample{wo.z < 0 ? mirror_z(exit->wi) : exit->wi, exit->weight,
                      pdf(b, upper, exit->wi), LobeKind::diffuse_reflection};
}

}  // namespace

bool is_specular(const CoatedConductorBsdf& b) {
    return are_borders_smooth(b) && !b.gap.scatters();
}

Rgb eval(const CoatedConductorBsdf& b, Vec3 wo, Vec3 wi) {
    if (!same_side(wo, wi)) return {};
    wo = to_upper_side(wo);
    wi = to_upper_side(wi);
    const CoatWalkSum base = eval_base(b, wo, wi);
    return Rgb(eval_coat(b, wo, wi)) + base.straight + base.scattered;
}

float pdf(const CoatedConductorBsdf& b, Vec3 wo, Vec3 wi) {
    if (!same_side(wo, wi) || is_specular(b)) return 0;
    wo = to_upper_side(wo);
    wi = to_upper_side(wi);
    const float eta = b.coat.eta;
    const DielectricFresnel o = fresnel_dielectric(wo.z, eta), i = fresnel_dielectric(wi.z, eta);
    const float coat =
        is_smooth(b) ? 0 : ggx_of(b.coat).reflection_pdf(wo, normalize(wo + wi)) * o.reflectance;
    if (o.cos_t == 0 || i.cos_t == 0) return coat;
    const Vec3 in_o{wo.x / eta, wo.y / eta, o.cos_t}, in_i{wi.x / eta, wi.y / eta, i.cos_t};
    // Solid angles outside are eta^2 cos_t / cos times as large. A tenth of what enters gets the
    // density of a cosine, for light that goes to and fro, and so does what the gap scatters.
    const float once = pdf(effective_metal(b), in_o, in_i) * wi.z / (sqr(eta) * i.cos_t);
    const float scattered = scattered_share(b, o.cos_t);
    const float below =
        0.9f * (1 - scattered) * once + (0.1f + 0.9f * scattered) * cosine_hemisphere_pdf(wi.z);
    return coat + (1 - o.reflectance) * below;
}

std::optional<BsdfSample> sample(const CoatedConductorBsdf& b, Vec3 wo, float u_lobe, Vec2 u) {
    const bool below = wo.z < 0;
    const Vec3 upper = to_upper_side(wo);
    if (is_specular(b))
        return BsdfSample{
            {-wo.x, -wo.y, wo.z}, smooth_reflectance(b, upper), 1, LobeKind::specular_reflection};
    if (are_borders_smooth(b)) return sample_hazy_mirror(b, wo, u_lobe, u);
    auto s = sample(b.coat, upper, u_lobe, u);
    if (!s) return {};
    if (!is_transmission(s->lobe)) {
        if (!is_smooth(b)) s->pdf = pdf(b, upper, s->wi);
        if (below) s->wi = mirror_z(s->wi);
        return s;
    }
    Rng rng = walk_numbers(upper, u_lobe, u);
    if (b.gap.scatters()) {
        const auto exit = follow_to_exit(layers(b), s->wi, s->weight, rng);
        if (!exit) return {};
        return BsdfSample{
            below ? mirror_z(exit->wi) : exit->wi, exit->weight, pdf(b, upper, exit->wi),
            exit->is_scattered ? LobeKind::diffuse_reflection : LobeKind::glossy_reflection};
    }
    Vec3 in = s->wi;
    Rgb weight = s->weight * attenuation(b, in);
    for (int bounce = 0; bounce < b.bounces; ++bounce) {
        const float u_metal = rng.next_float();
        const auto up = sample(b.metal, -in, u_metal, rng.next_2d());
        if (!up) return {};
        weight *= up->weight * attenuation(b, up->wi);
        const float u_coat = rng.next_float();
        const auto next = sample(b.coat, -up->wi, u_coat, rng.next_2d());
        if (!next) return {};
        weight *= next->weight;
        if (is_transmission(next->lobe)) {
            const Vec3 wi = next->wi;
            if (!(wi.z > 0)) return {};
            return BsdfSample{below ? mirror_z(wi) : wi, weight, pdf(b, upper, wi),
                              LobeKind::glossy_reflection};
        }
        in = next->wi;
        weight *= attenuation(b, in);
    }
    return {};
}

// The parts are computed anew, not from the value that the caller gives, which may be the random
// weight of `sample` times its density.
LobeShares lobe_shares(const CoatedConductorBsdf& b, Vec3 wo, Vec3 wi, Rgb) {
    if (!same_side(wo, wi) || is_specular(b)) return {};
    wo = to_upper_side(wo);
    wi = to_upper_side(wi);
    // Seen from outside, slopes are eta times as large.
    const ConductorBsdf m = effective_metal(b);
    const CoatWalkSum base = eval_base(b, wo, wi);
    LobeShares shares;
    const auto add = [&shares](const LobeShare& lobe) {
        shares.lobes[static_cast<size_t>(shares.count++)] = lobe;
    };
    if (!are_borders_smooth(b))
        add({LobeKind::glossy_reflection, base.straight, b.coat.eta * m.alpha_x,
             b.coat.eta * m.alpha_y});
    if (!is_smooth(b))
        add({LobeKind::glossy_reflection, Rgb(eval_coat(b, wo, wi)), b.coat.alpha_x,
             b.coat.alpha_y});
    if (b.gap.scatters()) add({LobeKind::diffuse_reflection, base.scattered, 0, 0, 1, b.coat.eta});
    return shares;
}

Rgb albedo(const CoatedConductorBsdf& b, Vec3 wo) {
    wo = to_upper_side(wo);
    const Rgb straight = smooth_reflectance(b, wo);
    const DielectricFresnel f = fresnel_dielectric(wo.z, b.coat.eta);
    if (!b.gap.scatters() || f.cos_t == 0) return straight;
    // About half of what is scattered once goes up, the rest comes back from the metal.
    const float met = (1 - f.reflectance) * scattered_share(b, f.cos_t);
    return straight + (0.5f * met) * b.gap.albedo * (Rgb(1) + reflectance(b.metal, 1));
}

}  // namespace covtrace
