/// A Lambertian base under a dielectric coat; the model is derived in coat_table.h.
#include "bsdf/coat_table.h"
#include "bsdf/fresnel.h"
#include "bsdf/ggx.h"
#include "bsdf/models.h"
#include "core/warp.h"

namespace covtrace {
namespace {

bool is_smooth(const CoatedDiffuseBsdf& b) {
    return b.eta == 1 || (b.alpha_x == 0 && b.alpha_y == 0);
}

/// Row of the tables for the coat's roughness towards w.
float table_row(const CoatedDiffuseBsdf& b, Vec3 w) {
    if (b.alpha_x == b.alpha_y) return b.table_row;
    const float x2 = sqr(b.alpha_x), y2 = sqr(b.alpha_y);
    return CoatTable::row_of(
        std::sqrt(x2 * sqr(w.x) + y2 * sqr(w.y) + 0.5f * (x2 + y2) * sqr(w.z)));
}

/// Reflectance of the coat's border at an angle.
Rgb border(const CoatedDiffuseBsdf& b, float cosine) {
    const float f = fresnel_dielectric(cosine, b.eta).reflectance;
    return b.tint.white ? tinted(b.tint, b.eta, cosine, f, 1) : Rgb(f);
}

/// Share of light along w that a tinted coat reflects, for w.z > 0 as in the rest of these helpers.
Rgb tinted_share(const CoatedDiffuseBsdf& b, Vec3 w) {
    if (is_smooth(b)) return border(b, w.z);
    const float row = table_row(b, w);
    return tinted(b.tint, b.eta, *b.table, row, w.z);
}

/// Shares of light along w that the coat reflects and lets through: T of coat_table.h, or all that
/// is not reflected where the coat is total. Of a tinted coat that of the channel that reflects
/// most.
CoatTable::Shares shares(const CoatedDiffuseBsdf& b, Vec3 w) {
    if (b.tint.white) {
        const float reflected = max_component(tinted_share(b, w));
        return {1 - reflected, reflected};
    }
    if (!is_smooth(b)) {
        CoatTable::Shares s = b.table->shares(table_row(b, w), w.z);
        if (b.is_total) s.transmission = 1 - s.reflection;
        return s;
    }
    const DielectricFresnel f = fresnel_dielectric(w.z, b.eta);
    if (b.is_total) return {1 - f.reflectance, f.reflectance};
    const float kept = f.cos_t == 0 ? 0.0f : std::exp(-b.table->thickness() / f.cos_t);
    return {(1 - f.reflectance) * kept, f.reflectance};
}

/// Factor on what the coat reflects of light along w, for the light that meets several facets.
float gain(const CoatedDiffuseBsdf& b, Vec3 w) {
    if (!b.white || is_smooth(b)) return 1;
    const float row = table_row(b, w), kept = b.white->shares(row, w.z).reflection;
    return 1 + b.table->regained(row) * (1 - kept) / kept;
}

/// Quantities of wo's side that a pair's value and density share.
struct Outgoing {
    Vec3 wo;
    float transmission;
    /// Probability of sampling the coat: its share of the reflected energy. Below 0 where nothing
    /// is reflected.
    float choose_coat;
    float stretched = 0;  ///< Ggx::stretched_length of wo, where the coat is rough
    float gain;           ///< on what the coat reflects

    Outgoing(const CoatedDiffuseBsdf& b, Vec3 direction)
        : wo(to_upper_side(direction)), gain(covtrace::gain(b, wo)) {
        const auto [t, coat] = shares(b, wo);
        transmission = t;
        const float base = max_component(b.base) * (kPi * t * b.mean_transmission);
        choose_coat = coat + base > 0 ? coat / (coat + base) : -1;
        if (!is_smooth(b)) stretched = Ggx{b.alpha_x, b.alpha_y}.stretched_length(wo);
    }
};

Rgb eval_base(const CoatedDiffuseBsdf& b, const Outgoing& out, Vec3 wi) {
    return b.base * (out.transmission * shares(b, wi).transmission * wi.z);
}

/// The coat's part of the value of a pair above the surface; `d`: density of the normals that
/// reflect it, `stretched`: Ggx::stretched_length of wo.
struct CoatValue {
    Rgb value;
    float d = 0;
};
CoatValue eval_coat(const CoatedDiffuseBsdf& b, Vec3 wo, float stretched, Vec3 wi) {
    const Ggx ggx{b.alpha_x, b.alpha_y};
    const Vec3 m = normalize(wo + wi);
    const float d = ggx.d(m);
    const float masked =
        2 * wi.z / (stretched * wi.z + ggx.stretched_length(wi) * wo.z);  // divided by wo.z
    return {border(b, dot(wo, m)) * (0.25f * d * masked), d};
}

BsdfValue value_and_density(const CoatedDiffuseBsdf& b, const Outgoing& out, Vec3 wi) {
    const Rgb base = eval_base(b, out, wi);
    const float base_pdf = (1 - out.choose_coat) * cosine_hemisphere_pdf(wi.z);
    if (is_smooth(b)) return {base, base_pdf};
    const CoatValue coat = eval_coat(b, out.wo, out.stretched, wi);
    return {out.gain * coat.value + base,
            out.choose_coat * coat.d / (2 * (out.wo.z + out.stretched)) + base_pdf};
}

}  // namespace

BsdfValue eval_and_pdf(const CoatedDiffuseBsdf& b, Vec3 wo, Vec3 wi) {
    if (!same_side(wo, wi)) return {};
    const Outgoing out(b, wo);
    return out.choose_coat < 0 ? BsdfValue{} : value_and_density(b, out, to_upper_side(wi));
}

Rgb eval(const CoatedDiffuseBsdf& b, Vec3 wo, Vec3 wi) {
    return eval_and_pdf(b, wo, wi).f;
}

float pdf(const CoatedDiffuseBsdf& b, Vec3 wo, Vec3 wi) {
    return eval_and_pdf(b, wo, wi).pdf;
}

std::optional<BsdfSample> sample(const CoatedDiffuseBsdf& b, Vec3 wo, float u_lobe, Vec2 u) {
    const bool below = wo.z < 0;
    const Outgoing out(b, wo);
    wo = out.wo;
    const float choose_coat = out.choose_coat;
    if (choose_coat < 0) return {};

    const bool from_coat = u_lobe < choose_coat;
    Vec3 wi;
    if (!from_coat) {
        wi = square_to_cosine_hemisphere(u);
    } else if (is_smooth(b)) {
        return BsdfSample{{-wo.x, -wo.y, below ? -wo.z : wo.z},
                          border(b, wo.z) / choose_coat,
                          choose_coat,
                          LobeKind::specular_reflection};
    } else {
        const Vec3 m = Ggx{b.alpha_x, b.alpha_y}.sample_visible_normal(wo, u);
        wi = normalize(m * (2 * dot(wo, m)) - wo);
    }
    if (!(wi.z > 0)) return {};
    const auto [value, density] = value_and_density(b, out, wi);
    if (!(density > 0)) return {};
    return BsdfSample{below ? mirror_z(wi) : wi, value / density, density,
                      from_coat ? LobeKind::glossy_reflection : LobeKind::diffuse_reflection};
}

LobeShares lobe_shares(const CoatedDiffuseBsdf& b, Vec3 wo, Vec3 wi, Rgb value) {
    if (!same_side(wo, wi)) return {};
    LobeShares found{{LobeShare{LobeKind::diffuse_reflection, value, 0, 0, 1, b.eta}}, 1};
    if (is_smooth(b)) return found;
    wo = to_upper_side(wo);
    const float stretched = Ggx{b.alpha_x, b.alpha_y}.stretched_length(wo);
    const Rgb coat = gain(b, wo) * eval_coat(b, wo, stretched, to_upper_side(wi)).value;
    for (int c = 0; c < 3; ++c) found.lobes[0].value[c] = std::max(0.0f, value[c] - coat[c]);
    found.lobes[1] = {LobeKind::glossy_reflection, coat, b.alpha_x, b.alpha_y, 1, b.eta};
    found.count = 2;
    return found;
}

Rgb albedo(const CoatedDiffuseBsdf& b, Vec3 wo) {
    wo = to_upper_side(wo);
    const auto [transmission, coat] = shares(b, wo);
    return (b.tint.white ? tinted_share(b, wo) : Rgb(coat)) +
           b.base * (kPi * transmission * b.mean_transmission);
}

}  // namespace covtrace
