#include "bsdf/hair.h"

#include <algorithm>
#include <cmath>

#include "bsdf/models.h"
#include "core/fast_math.h"

namespace covtrace {
namespace {

constexpr size_t kTilted = 3;  ///< ways whose light the scales turn: all but the rest

float power(float x, int n) {
    float y = 1;
    for (; n > 0; n /= 2, x *= x)
        if (n % 2 == 1) y *= x;
    return y;
}

/// Variance of the angle to the cross section, by the fit of Chiang et al. 2016.
float variance_of(float beta_m) {
    return sqr(0.726f * beta_m + 0.812f * sqr(beta_m) + 3.7f * power(beta_m, 20));
}

/// Scale of the logistic distribution about the strand, by the fit of Chiang et al. 2016.
float scale_of(float beta_n) {
    constexpr float kRootOfPiOver8 = 0.626657069f;
    return kRootOfPiOver8 * (0.265f * beta_n + 1.194f * sqr(beta_n) + 5.372f * power(beta_n, 22));
}

/// The modified Bessel function of order 0 times exp(-x), for x >= 0, within 2e-7: Abramowitz and
/// Stegun 1964, 9.8.1 and 9.8.2.
float scaled_bessel(float x) {
    constexpr float kBorder = 3.75f;
    if (x < kBorder) {
        const float t = sqr(x / kBorder);
        const float i0 =
            1 + t * (3.5156229f +
                     t * (3.0899424f +
                          t * (1.2067492f + t * (0.2659732f + t * (0.0360768f + t * 0.0045813f)))));
        return std::exp(-x) * i0;
    }
    const float t = kBorder / x;
    float p = -0.01647633f + t * 0.00392377f;
    p = 0.02635537f + t * p;
    p = -0.02057706f + t * p;
    p = 0.00916281f + t * p;
    p = -0.00157565f + t * p;
    p = 0.00225319f + t * p;
    p = 0.01328592f + t * p;
    p = 0.39894228f + t * p;
    return p / std::sqrt(x);
}

/// Sine and cosine of the angle between a direction and the cross section of the strand.
struct Inclination {
    float sin, cos;
    static Inclination of(Vec3 w) { return {w.x, std::sqrt(sqr(w.y) + sqr(w.z))}; }
};

/// M_p, the density of the sine of the inclination of wi: that of d'Eon et al. 2011, "An
/// Energy-Conserving Hair Reflectance Model", written with the distance of both directions, which
/// does not cancel where v is small.
float along_strand(const HairBsdf& b, size_t way, Inclination o, Inclination i) {
    const float v = b.variance[way];
    const float distance = 0.5f * (sqr(i.cos - o.cos) + sqr(i.sin + o.sin));
    return std::exp(-distance / v) * scaled_bessel(i.cos * o.cos / v) / (v * (1 - b.faintest[way]));
}

/// An angle less whole turns, in [-pi, pi].
float wrapped(float angle) {
    return angle - 2 * kPi * std::floor(angle * (0.5f * kInvPi) + 0.5f);
}

/// N_p, the density of the angle `phi` about the strand from where a smooth strand would send the
/// light: a logistic distribution cut off at half a turn.
float about_strand(const HairBsdf& b, float phi) {
    const float e = std::exp(-std::abs(wrapped(phi)) / b.scale);
    return e / (b.scale * sqr(1 + e) * (1 - 2 * b.tail));
}

/// All that depends on wo alone.
struct Outgoing {
    std::array<Rgb, HairBsdf::kWays> shares;           ///< A_p
    std::array<float, HairBsdf::kWays> probabilities;  ///< of `sample`
    std::array<Inclination, HairBsdf::kWays> tilted;   ///< wo, turned by the scales
    std::array<float, kTilted> turns;                  ///< about a smooth strand

    Outgoing(const HairBsdf& b, Vec3 wo);
};

Outgoing::Outgoing(const HairBsdf& b, Vec3 wo) {
    const Inclination o = Inclination::of(wo);
    // Refract the ray into the cross section, where the index is another one
    const float h = b.offset, cos_gamma_o = safe_sqrt(1 - h * h);
    const float sin_theta_t = o.sin / b.eta, cos_theta_t = safe_sqrt(1 - sqr(sin_theta_t));
    const float depth = safe_sqrt(sqr(b.eta) - sqr(o.sin));
    const float sin_gamma_t =
        depth > 0 ? std::clamp(h * o.cos / depth, -1.0f, 1.0f) : std::copysign(1.0f, h);
    const float cos_gamma_t = safe_sqrt(1 - sqr(sin_gamma_t));
    // Find the shares: a geometric series of reflections inside
    const float f = fresnel_dielectric(o.cos * cos_gamma_o, b.eta).reflectance;
    const float way = cos_theta_t > 0 ? 2 * cos_gamma_t / cos_theta_t : 0.0f;
    shares[0] = Rgb(f);
    for (int c = 0; c < 3; ++c) {
        const float passed = std::exp(-b.absorption[c] * way);
        shares[1][c] = sqr(1 - f) * passed;
        shares[2][c] = shares[1][c] * passed * f;
        const float lost = 1 - passed * f;
        shares[3][c] = lost > 0 ? shares[2][c] * passed * f / lost : 0.0f;
    }
    // The channel that is absorbed least has the largest part of each share, so that no weight of a
    // sample is above 1
    float sum = 0;
    for (size_t p = 0; p < HairBsdf::kWays; ++p) sum += probabilities[p] = max_component(shares[p]);
    for (float& p : probabilities) p = sum > 0 ? p / sum : 0.0f;
    for (size_t p = 0; p < HairBsdf::kWays; ++p)
        tilted[p] = {o.sin * b.cos_tilt[p] + o.cos * b.sin_tilt[p],
                     std::abs(o.cos * b.cos_tilt[p] - o.sin * b.sin_tilt[p])};
    const float gamma_o = std::asin(h), gamma_t = std::asin(sin_gamma_t);
    for (size_t p = 0; p < kTilted; ++p)
        turns[p] = static_cast<float>(p) * (2 * gamma_t + kPi) - 2 * gamma_o;
}

/// M_p N_p of all ways, for the direction wi.
std::array<float, HairBsdf::kWays> densities(const HairBsdf& b, const Outgoing& out, Vec3 wo,
                                             Vec3 wi) {
    const Inclination i = Inclination::of(wi);
    const float phi =
        arctangent(wo.y * wi.z - wo.z * wi.y, wo.y * wi.y + wo.z * wi.z);  // from wo to wi
    std::array<float, HairBsdf::kWays> all;
    for (size_t p = 0; p < HairBsdf::kWays; ++p)
        all[p] = along_strand(b, p, out.tilted[p], i) *
                 (p < kTilted ? about_strand(b, phi - out.turns[p]) : 0.5f * kInvPi);
    return all;
}

BsdfValue value_and_density(const HairBsdf& b, const Outgoing& out, Vec3 wo, Vec3 wi) {
    const auto all = densities(b, out, wo, wi);
    BsdfValue value;
    for (size_t p = 0; p < HairBsdf::kWays; ++p) {
        value.f += out.shares[p] * all[p];
        value.pdf += out.probabilities[p] * all[p];
    }
    return value;
}

/// The sine of an inclination that follows M_p for the inclination `o`: d'Eon et al. 2013,
/// "Importance Sampling for Physically-Based Hair Fiber Models".
float sample_along(const HairBsdf& b, size_t way, Inclination o, Vec2 u) {
    const float below =
        -b.variance[way] * std::log(std::max(u.x + (1 - u.x) * b.faintest[way], 1e-30f));
    const float x = std::clamp(below, 0.0f, 2.0f);  // 1 - the cosine to the middle of the lobe
    return std::sqrt(x * (2 - x)) * std::cos(2 * kPi * u.y) * o.cos - (1 - x) * o.sin;
}

/// An angle that follows N_p, from where a smooth strand would send the light.
float sample_about(const HairBsdf& b, float u) {
    const float share = b.tail + u * (1 - 2 * b.tail);
    return std::clamp(-b.scale * std::log(1 / share - 1), -kPi, kPi);
}

bool is_seen_edge_on(Vec3 wo, Vec3 wi) {
    return wo.z == 0 || wi.z == 0;
}

LobeKind kind_of(Vec3 wo, Vec3 wi) {
    return same_side(wo, wi) ? LobeKind::hair_reflection : LobeKind::hair_transmission;
}

}  // namespace

HairBsdf make_hair(const HairShape& shape, Rgb absorption) {
    constexpr float kLeast = 1e-3f;  // sharper lobes feel the rounding of directions
    const float beta_m = std::clamp(shape.beta_m, kLeast, 1.0f);
    const float beta_n = std::clamp(shape.beta_n, kLeast, 1.0f);
    const float first = std::clamp((1 - shape.coat) * beta_m, kLeast, 1.0f);
    HairBsdf b;
    b.absorption = absorption;
    b.eta = std::max(shape.eta, 1.0f);
    const float v = variance_of(beta_m);
    b.variance = {variance_of(first), 0.25f * v, 4 * v, 4 * v};
    constexpr std::array<float, HairBsdf::kWays> kTurns{-2, 1, 4, 0};
    for (size_t p = 0; p < HairBsdf::kWays; ++p) {
        b.faintest[p] = std::exp(-2 / b.variance[p]);
        const float tilt = kTurns[p] * shape.alpha * (kPi / 180);
        b.sin_tilt[p] = std::sin(tilt);
        b.cos_tilt[p] = std::cos(tilt);
    }
    b.scale = scale_of(beta_n);
    b.tail = 1 / (1 + std::exp(kPi / b.scale));
    return b;
}

Rgb absorption_of_reflectance(Rgb reflectance, float beta_n) {
    constexpr float kLeast = 1e-5f;
    const float b = beta_n;
    const float scale =
        5.969f + b * (-0.215f + b * (2.532f + b * (-10.73f + b * (5.574f + b * 0.245f))));
    Rgb absorption;
    for (int c = 0; c < 3; ++c)
        absorption[c] = sqr(std::log(std::clamp(reflectance[c], kLeast, 1.0f)) / scale);
    return absorption;
}

Rgb absorption_of_pigments(float eumelanin, float pheomelanin) {
    return eumelanin * Rgb{0.419f, 0.697f, 1.37f} + pheomelanin * Rgb{0.187f, 0.4f, 1.05f};
}

BsdfValue eval_and_pdf(const HairBsdf& b, Vec3 wo, Vec3 wi) {
    if (is_seen_edge_on(wo, wi)) return {};
    return value_and_density(b, Outgoing(b, wo), wo, wi);
}

Rgb eval(const HairBsdf& b, Vec3 wo, Vec3 wi) {
    return eval_and_pdf(b, wo, wi).f;
}

float pdf(const HairBsdf& b, Vec3 wo, Vec3 wi) {
    return eval_and_pdf(b, wo, wi).pdf;
}

std::optional<BsdfSample> sample(const HairBsdf& b, Vec3 wo, float u_lobe, Vec2 u) {
    const Outgoing out(b, wo);
    // Choose a way, and spread the number that chose it
    size_t way = 0;
    while (way + 1 < HairBsdf::kWays && u_lobe >= out.probabilities[way])
        u_lobe -= out.probabilities[way++];
    if (!(out.probabilities[way] > 0)) return {};
    const float u_about = std::min(u_lobe / out.probabilities[way], 1 - 0x1p-24f);
    // Sample the angles to the cross section and about the strand
    const float sin_theta = std::clamp(sample_along(b, way, out.tilted[way], u), -1.0f, 1.0f);
    const float cos_theta = safe_sqrt(1 - sqr(sin_theta));
    const float phi =
        arctangent(wo.z, wo.y) +
        (way < kTilted ? out.turns[way] + sample_about(b, u_about) : 2 * kPi * u_about);
    const SinCos about = sin_cos(phi);
    const Vec3 wi{sin_theta, cos_theta * about.cos, cos_theta * about.sin};
    if (wi.z == 0) return {};
    const BsdfValue value = value_and_density(b, out, wo, wi);
    if (!(value.pdf > 0)) return {};
    return BsdfSample{wi, value.f / value.pdf, value.pdf, kind_of(wo, wi)};
}

LobeShares lobe_shares(const HairBsdf& b, Vec3 wo, Vec3 wi, Rgb) {
    if (is_seen_edge_on(wo, wi)) return {};
    const Outgoing out(b, wo);
    const auto all = densities(b, out, wo, wi);
    LobeShares shares;
    for (size_t p = 0; p < HairBsdf::kWays; ++p) {
        LobeShare& lobe = shares.lobes[p];
        lobe.kind = kind_of(wo, wi);
        lobe.value = out.shares[p] * all[p];
        lobe.alpha_x = std::sqrt(b.variance[p]);
        // A logistic distribution is as curved at its peak as a Gaussian of twice the variance s^2
        lobe.alpha_y =
            p < kTilted ? std::sqrt(2.0f) * b.scale : std::numeric_limits<float>::infinity();
    }
    shares.count = HairBsdf::kWays;
    return shares;
}

Rgb albedo(const HairBsdf& b, Vec3 wo) {
    Rgb sum;
    for (const Rgb& share : Outgoing(b, wo).shares) sum += share;
    return sum;
}

}  // namespace covtrace
