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
#include <array>
#include <bit>

#include "bsdf/fresnel.h"
#include "bsdf/ggx.h"
#include "bsdf/models.h"
#include "core/rng.h"
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
float power_heuristic(float a, float b) {
    return sqr(a) / (sqr(a) + sqr(b));
}

/// A direction through the coat, or off its inside: which of the two was decided before, so that
/// the weight holds Fresnel's share. For refraction it has no factor 1 / eta^2.
struct Crossing {
    Vec3 w;
    float weight = 0;
    float pdf = 0;  ///< density of refraction through a rough coat, else 1
};

Ggx coat_ggx(const CoatedConductorBsdf& b) {
    return {b.coat.alpha_x, b.coat.alpha_y};
}

/// Samples a refraction from the outside direction w (w.z > 0) to one inside (z < 0).
std::optional<Crossing> enter(const CoatedConductorBsdf& b, Vec3 w, Vec2 u) {
    const float eta = b.coat.eta;
    if (is_smooth(b)) {
        const DielectricFresnel f = fresnel_dielectric(w.z, eta);
        if (f.cos_t == 0) return {};
        return Crossing{{-w.x / eta, -w.y / eta, -f.cos_t}, 1 - f.reflectance, 1};
    }
    const Ggx ggx = coat_ggx(b);
    const Vec3 m = ggx.sample_visible_normal(w, u);
    const float cos_o = dot(w, m);
    if (!(cos_o > 0)) return {};
    const DielectricFresnel f = fresnel_dielectric(cos_o, eta);
    const Vec3 in = normalize(m * (cos_o / eta - f.cos_t) - w / eta);
    if (!(in.z < 0) || !(f.reflectance < 1)) return {};
    const float pdf =
        ggx.visible_normal_pdf(w, m) * sqr(eta) * f.cos_t / sqr(eta * f.cos_t - cos_o);
    if (!(pdf > 0) || !std::isfinite(pdf)) return {};
    return Crossing{in, (1 - f.reflectance) * ggx.g2_over_g1(w, mirror_z(in)), pdf};
}

/// Density of `enter` on a rough coat to give the direction `in`.
float enter_pdf(const CoatedConductorBsdf& b, Vec3 w, Vec3 in) {
    const float eta = b.coat.eta;
    const Vec3 half = w + in * eta;
    const float length2 = length_squared(half);
    if (!(length2 > 0)) return 0;
    const Vec3 m = half / std::copysign(std::sqrt(length2), half.z);
    if (!(dot(w, m) > 0) || !(dot(in, m) < 0)) return 0;
    return coat_ggx(b).visible_normal_pdf(w, m) * sqr(eta) * std::abs(dot(in, m)) / length2;
}

/// Samples a reflection off the coat's inside. `w` (z < 0) points back to where the walk came from;
/// the result, with z < 0 too, is the direction in which the walk goes on.
std::optional<Crossing> reflect_inside(const CoatedConductorBsdf& b, Vec3 w, Vec2 u) {
    w = mirror_z(w);
    const float eta = 1 / b.coat.eta;
    if (is_smooth(b))
        return Crossing{{-w.x, -w.y, -w.z}, fresnel_dielectric(w.z, eta).reflectance, 1};
    const Ggx ggx = coat_ggx(b);
    const Vec3 m = ggx.sample_visible_normal(w, u);
    const float cos_o = dot(w, m);
    if (!(cos_o > 0)) return {};
    const Vec3 out = normalize(m * (2 * cos_o) - w);
    if (!(out.z > 0)) return {};
    return Crossing{mirror_z(out),
                    fresnel_dielectric(cos_o, eta).reflectance * ggx.g2_over_g1(w, out), 1};
}

uint64_t bits_of(Vec3 w) {
    return hash_combine(std::bit_cast<uint32_t>(w.x), std::bit_cast<uint32_t>(w.y),
                        std::bit_cast<uint32_t>(w.z));
}

/// Estimate of f - f_coat by one random walk; both directions are outside, z > 0.
Rgb walk(const CoatedConductorBsdf& b, Vec3 wo, Vec3 wi, Rng& rng) {
    const auto first = enter(b, wo, rng.next_2d());
    const auto last = enter(b, wi, rng.next_2d());
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
            const float share = smooth_metal ? 1 : power_heuristic(s->pdf, enter_pdf(b, wi, below));
            sum += beta * eval(b.coat, below, wi) * (share / wi.z);
        }
        if (bounce + 1 >= b.bounces) break;
        const auto back = reflect_inside(b, below, rng.next_2d());
        if (!back) break;
        in = back->w;
        beta *= back->weight * attenuation(b, in);
    }
    return sum;
}

float eval_coat(const CoatedConductorBsdf& b, Vec3 wo, Vec3 wi) {
    return is_smooth(b) ? 0 : eval(b.coat, wo, wi).r;
}

Rgb eval_base(const CoatedConductorBsdf& b, Vec3 wo, Vec3 wi) {
    constexpr float kGrazing = 1e-6f;  // below, the walk's quotients overflow
    if (is_specular(b) || std::min(wo.z, wi.z) < kGrazing) return {};
    const float cos_i = wi.z;
    uint64_t hash_o = bits_of(wo), hash_i = bits_of(wi);
    if (hash_o > hash_i && !b.metal.white) {
        std::swap(wo, wi);
        std::swap(hash_o, hash_i);
    }
    Rng rng(hash_combine(hash_o, hash_i, b.place));
    Rgb sum;
    for (int i = 0; i < b.samples; ++i) sum += walk(b, wo, wi, rng);
    return sum * (cos_i / static_cast<float>(b.samples));
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

}  // namespace

bool is_specular(const CoatedConductorBsdf& b) {
    return is_smooth(b) && is_metal_smooth(b);
}

Rgb eval(const CoatedConductorBsdf& b, Vec3 wo, Vec3 wi) {
    if (!same_side(wo, wi)) return {};
    wo = to_upper_side(wo);
    wi = to_upper_side(wi);
    return Rgb(eval_coat(b, wo, wi)) + eval_base(b, wo, wi);
}

float pdf(const CoatedConductorBsdf& b, Vec3 wo, Vec3 wi) {
    if (!same_side(wo, wi) || is_specular(b)) return 0;
    wo = to_upper_side(wo);
    wi = to_upper_side(wi);
    const float eta = b.coat.eta;
    const DielectricFresnel o = fresnel_dielectric(wo.z, eta), i = fresnel_dielectric(wi.z, eta);
    const float coat =
        is_smooth(b) ? 0 : coat_ggx(b).reflection_pdf(wo, normalize(wo + wi)) * o.reflectance;
    if (o.cos_t == 0 || i.cos_t == 0) return coat;
    const Vec3 in_o{wo.x / eta, wo.y / eta, o.cos_t}, in_i{wi.x / eta, wi.y / eta, i.cos_t};
    // Solid angles outside are eta^2 cos_t / cos times as large. A tenth of what enters gets the
    // density of a cosine, for light that goes to and fro.
    const float once = pdf(effective_metal(b), in_o, in_i) * wi.z / (sqr(eta) * i.cos_t);
    return coat + (1 - o.reflectance) * (0.9f * once + 0.1f * cosine_hemisphere_pdf(wi.z));
}

std::optional<BsdfSample> sample(const CoatedConductorBsdf& b, Vec3 wo, float u_lobe, Vec2 u) {
    const bool below = wo.z < 0;
    const Vec3 upper = to_upper_side(wo);
    if (is_specular(b))
        return BsdfSample{
            {-wo.x, -wo.y, wo.z}, smooth_reflectance(b, upper), 1, LobeKind::specular_reflection};
    auto s = sample(b.coat, upper, u_lobe, u);
    if (!s) return {};
    if (!is_transmission(s->lobe)) {
        if (!is_smooth(b)) s->pdf = pdf(b, upper, s->wi);
        if (below) s->wi = mirror_z(s->wi);
        return s;
    }
    Rng rng(hash_combine(bits_of(upper), std::bit_cast<uint32_t>(u_lobe),
                         std::bit_cast<uint32_t>(u.x), std::bit_cast<uint32_t>(u.y)));
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
    LobeShares shares{{LobeShare{LobeKind::glossy_reflection, eval_base(b, wo, wi),
                                 b.coat.eta * m.alpha_x, b.coat.eta * m.alpha_y}},
                      1};
    if (!is_smooth(b))
        shares.lobes[1] = {LobeKind::glossy_reflection, Rgb(eval_coat(b, wo, wi)), b.coat.alpha_x,
                           b.coat.alpha_y},
        shares.count = 2;
    return shares;
}

Rgb albedo(const CoatedConductorBsdf& b, Vec3 wo) {
    return smooth_reflectance(b, to_upper_side(wo));
}

}  // namespace covtrace
