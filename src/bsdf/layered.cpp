/// A surface under a sheen, under a clear coat: glTF's KHR_materials_sheen and
/// KHR_materials_clearcoat, and the coat of Blender's Principled. With B the surface below, c the
/// sheen's colour, E its albedo, w the coat's weight, and R what a full coat reflects of light
/// along wo, by its own normal,
///
///    f(wo, wi) = w f_coat(wo, wi) + (1 - w R(wo)) t(wo) (c f_sheen(wo, wi) + s B(wo, wi))
///    s = 1 - max(c) max(E(wo), E(wi))
///
/// glTF's coat has R = F(wo), Schlick's reflectance of a border of index 1.5, and f_coat = F(wo)
/// times GGX without a Fresnel factor. A coat that has a border of its own, as Blender's, has GGX
/// with Fresnel's reflectance for f_coat, and that lobe's albedo for R. Its tint k is that of light
/// along the normal; light along wo takes the longer way, t = 1 - w + w k^(1 / cos), by the cosine
/// inside the coat. All layers conserve energy: none takes less from what is below than it reflects
/// itself.
#include <algorithm>
#include <cmath>

#include "bsdf/coat_table.h"
#include "bsdf/ggx.h"
#include "bsdf/models.h"
#include "bsdf/sheen.h"
#include "core/frame.h"
#include "core/warp.h"

namespace covtrace {
namespace {

constexpr float kUniformHemispherePdf = kInvPi / 2;

/// Share of light with the given cosine that a full coat reflects.
float coat_reflectance(const ClearcoatLobe& coat, float cosine) {
    if (coat.border) {
        if (coat.alpha == 0) return fresnel_dielectric(cosine, coat.border->eta()).reflectance;
        return coat.border->shares(CoatTable::row_of(coat.alpha), cosine).reflection;
    }
    // Schlick's formula, as the extension has it
    constexpr float kNormal = 0.04f;
    const float m = 1 - clamp01(cosine);
    return kNormal + (1 - kNormal) * (m * m) * (m * m) * m;
}

/// Share of the light below a coat that gets out with the given cosine: what it neither reflects
/// nor absorbs.
Rgb coat_transmission(const ClearcoatLobe& coat, float cosine) {
    if (!(coat.weight > 0)) return Rgb(1);
    const float passed = 1 - coat.weight * coat_reflectance(coat, cosine);
    if (coat.tint == Rgb(1)) return Rgb(passed);
    constexpr float kIndex = 1.5f;  // where the coat tells none
    const float eta = coat.border ? coat.border->eta() : kIndex;
    const float way = 1 / safe_sqrt(1 - (1 - sqr(cosine)) / sqr(eta));
    Rgb t;
    for (int c = 0; c < 3; ++c)
        t[c] = passed * (1 - coat.weight + coat.weight * std::pow(coat.tint[c], way));
    return t;
}

/// Whether w is inside of a body, whose border has its layers on the outside.
bool is_inside(const LayeredBsdf& b, Vec3 w) {
    return w.z < 0 && std::holds_alternative<DielectricBsdf>(b.base);
}

/// Albedo of the sheen in its strongest channel.
float strongest_sheen(const SheenLobe& sheen, float cosine) {
    return max_component(sheen.colour) * std::min(1.0f, sheen.table->albedo(sheen.alpha, cosine));
}

float largest_albedo(const LayeredBsdf& b, Vec3 wo) {
    if (std::holds_alternative<DielectricBsdf>(b.base) ||
        std::holds_alternative<ThinDielectricBsdf>(b.base))
        return 1;
    const float by_direction = max_component(albedo(base_of(b), wo));
    // A rough metal's facets face other angles, too, where its edge is less dark: at least the mean
    // of Schlick's reflectance over the hemisphere
    constexpr float kMeanOfFifthPower = 1 / 21.0f;
    const auto* metal = std::get_if<ConductorBsdf>(&b.base);
    if (!metal || !metal->schlick || metal->alpha_x == 0) return by_direction;
    const auto& [normal, grazing, dip] = *metal->schlick;
    return std::max(by_direction, max_component(normal + kMeanOfFifthPower * (grazing - normal)));
}

/// Quantities of wo's side that a pair's value and density share.
struct Outgoing {
    Bsdf base;
    Vec3 wo;              ///< on the upper side
    Frame coat;           ///< about the coat's normal
    Vec3 wo_coat;         ///< in that frame
    float reflected = 0;  ///< share that the coat reflects: w R(wo)
    Rgb below{1};         ///< share that what is below gets out through the coat
    float sheen = 0;      ///< albedo of the sheen in its strongest channel: max(c) E(wo)
    /// Probabilities of sampling the coat and the sheen; the base has the rest.
    float choose_coat = 0, choose_sheen = 0;
    bool is_black = false;  ///< whether nothing is reflected or transmitted

    Outgoing(const LayeredBsdf& b, Vec3 direction)
        : base(base_of(b)), wo(to_upper_side(direction)) {
        if (is_inside(b, direction)) return;
        if (b.coat.weight > 0) {
            coat = Frame::from_z(b.coat.normal);
            wo_coat = coat.to_local(wo);
            if (wo_coat.z > 0) {
                reflected = b.coat.weight * coat_reflectance(b.coat, wo_coat.z);
                below = coat_transmission(b.coat, wo_coat.z);
            }
        }
        if (has_sheen(b)) sheen = strongest_sheen(b.sheen, wo.z);
        const float passed = max_component(below);
        const float rest = passed * (1 - sheen) * largest_albedo(b, direction);
        const float all = reflected + passed * sheen + rest;
        is_black = !(all > 0);
        if (is_black) return;
        choose_coat = reflected / all;
        choose_sheen = passed * sheen / all;
    }
    float choose_base() const { return 1 - choose_coat - choose_sheen; }

    static bool has_sheen(const LayeredBsdf& b) { return max_component(b.sheen.colour) > 0; }
    static float sheen_albedo(const LayeredBsdf& b, float cosine) {
        return std::min(1.0f, b.sheen.table->albedo(b.sheen.alpha, cosine));
    }
};

/// Factor on what the base does with a pair.
Rgb base_scale(const LayeredBsdf& b, const Outgoing& out, Vec3 wi) {
    if (!(out.sheen > 0)) return out.below;
    const float in = strongest_sheen(b.sheen, std::abs(wi.z));
    return out.below * (1 - std::max(out.sheen, in));
}

/// The layers' parts of a pair above the surface, wi on the upper side, and the density with which
/// they sample it.
struct LayerValues {
    Rgb sheen, coat;
    float pdf = 0;
};
LayerValues layers(const LayeredBsdf& b, const Outgoing& out, Vec3 wi) {
    LayerValues v;
    if (out.sheen > 0) {
        const SheenTable& table = *b.sheen.table;
        const float excess = std::max(
            {1.0f, table.albedo(b.sheen.alpha, out.wo.z), table.albedo(b.sheen.alpha, wi.z)});
        v.sheen = b.sheen.colour * out.below * (sheen_value(b.sheen.alpha, out.wo, wi) / excess);
        v.pdf = out.choose_sheen * kUniformHemispherePdf;
    }
    if (!(out.reflected > 0) || b.coat.alpha == 0) return v;
    const Vec3 wi_coat = out.coat.to_local(wi);
    if (!(wi_coat.z > 0)) return v;
    const Ggx ggx{b.coat.alpha, b.coat.alpha};
    const Vec3 m = normalize(out.wo_coat + wi_coat);
    const float border =
        b.coat.border
            ? b.coat.weight *
                  fresnel_dielectric(dot(out.wo_coat, m), b.coat.border->eta()).reflectance
            : out.reflected;
    v.coat = Rgb(border * 0.25f * ggx.d(m) * ggx.g2_over_cos_o(out.wo_coat, wi_coat));
    v.pdf += out.choose_coat * ggx.reflection_pdf(out.wo_coat, m);
    return v;
}

BsdfValue value_and_density(const LayeredBsdf& b, const Outgoing& out, Vec3 wo, Vec3 wi) {
    BsdfValue v = eval_and_pdf(out.base, wo, wi);
    v.f *= base_scale(b, out, wi);
    v.pdf *= out.choose_base();
    if (!same_side(wo, wi)) return v;
    const LayerValues above = layers(b, out, to_upper_side(wi));
    return {v.f + above.sheen + above.coat, v.pdf + above.pdf};
}

/// A direction that the coat reflects to, on the upper side; empty where it is below the surface.
std::optional<Vec3> sample_coat(const LayeredBsdf& b, const Outgoing& out, Vec2 u) {
    const Vec3 m = b.coat.alpha > 0
                       ? Ggx{b.coat.alpha, b.coat.alpha}.sample_visible_normal(out.wo_coat, u)
                       : Vec3{0, 0, 1};
    const Vec3 wi_coat = normalize(m * (2 * dot(out.wo_coat, m)) - out.wo_coat);
    const Vec3 wi = out.coat.to_world(wi_coat);
    if (!(wi_coat.z > 0 && wi.z > 0)) return {};
    return wi;
}

}  // namespace

Rgb layer_transmission(const SheenLobe& sheen, const ClearcoatLobe& coat, float cosine) {
    const Rgb below = coat_transmission(coat, cosine);
    return max_component(sheen.colour) > 0 ? below * (1 - strongest_sheen(sheen, cosine)) : below;
}

BsdfValue eval_and_pdf(const LayeredBsdf& b, Vec3 wo, Vec3 wi) {
    if (wo.z == 0 || wi.z == 0) return {};
    const Outgoing out(b, wo);
    return out.is_black ? BsdfValue{} : value_and_density(b, out, wo, wi);
}

Rgb eval(const LayeredBsdf& b, Vec3 wo, Vec3 wi) {
    return eval_and_pdf(b, wo, wi).f;
}

float pdf(const LayeredBsdf& b, Vec3 wo, Vec3 wi) {
    return eval_and_pdf(b, wo, wi).pdf;
}

std::optional<BsdfSample> sample(const LayeredBsdf& b, Vec3 wo, float u_lobe, Vec2 u) {
    const Outgoing out(b, wo);
    if (out.is_black) return {};
    const auto on_side = [&](Vec3 w) { return wo.z < 0 ? mirror_z(w) : w; };
    BsdfSample s;
    if (u_lobe < out.choose_coat) {
        const auto wi = sample_coat(b, out, u);
        if (!wi) return {};
        if (b.coat.alpha == 0)
            return BsdfSample{on_side(*wi), Rgb(out.reflected / out.choose_coat), out.choose_coat,
                              LobeKind::specular_reflection};
        s = {on_side(*wi), {}, 0, LobeKind::glossy_reflection};
    } else if (u_lobe < out.choose_coat + out.choose_sheen) {
        const Vec3 wi = square_to_cone(u, 1);
        if (!(wi.z > 0)) return {};
        s = {on_side(wi), {}, 0, LobeKind::sheen_reflection};
    } else {
        constexpr float kBelowOne = 1 - 0x1p-24f;
        const float share = out.choose_base();
        const float u_base = (u_lobe - out.choose_coat - out.choose_sheen) / share;
        const auto below = covtrace::sample(out.base, wo, std::min(u_base, kBelowOne), u);
        if (!below) return {};
        s = *below;
        if (is_specular(s.lobe)) {
            s.weight *= base_scale(b, out, s.wi) * (1 / share);
            s.pdf *= share;
            return s;
        }
    }
    const BsdfValue v = value_and_density(b, out, wo, s.wi);
    if (!(v.pdf > 0)) return {};
    s.weight = v.f / v.pdf;
    s.pdf = v.pdf;
    return s;
}

LobeShares lobe_shares(const LayeredBsdf& b, Vec3 wo, Vec3 wi, Rgb value) {
    const Outgoing out(b, wo);
    if (out.is_black) return {};
    const LayerValues above = same_side(wo, wi) ? layers(b, out, to_upper_side(wi)) : LayerValues{};
    const Rgb scale = base_scale(b, out, wi);
    LobeShares found;
    if (!is_black(scale)) {
        Rgb below;
        for (int c = 0; c < 3; ++c)
            if (scale[c] > 0)
                below[c] = std::max(0.0f, value[c] - above.sheen[c] - above.coat[c]) / scale[c];
        found = covtrace::lobe_shares(out.base, wo, wi, below);
        for (int i = 0; i < found.count; ++i) found.lobes[static_cast<size_t>(i)].value *= scale;
    }
    const auto add = [&found](const LobeShare& lobe) {
        if (!is_black(lobe.value)) found.lobes[static_cast<size_t>(found.count++)] = lobe;
    };
    add({LobeKind::sheen_reflection, above.sheen, b.sheen.alpha, b.sheen.alpha});
    add({LobeKind::glossy_reflection, above.coat, b.coat.alpha, b.coat.alpha, 1,
         b.coat.border ? b.coat.border->eta() : 0, 0,
         wo.z < 0 ? mirror_z(b.coat.normal) : b.coat.normal});
    return found;
}

bool is_specular(const LayeredBsdf& b) {
    const bool is_rough = (b.coat.weight > 0 && b.coat.alpha > 0) || Outgoing::has_sheen(b);
    return !is_rough && covtrace::is_specular(base_of(b));
}

Rgb albedo(const LayeredBsdf& b, Vec3 wo) {
    const Outgoing out(b, wo);
    const Rgb base = albedo(out.base, wo);
    if (!(out.sheen > 0)) return Rgb(out.reflected) + out.below * base;
    const Rgb sheen = b.sheen.colour * Outgoing::sheen_albedo(b, out.wo.z);
    return Rgb(out.reflected) + out.below * (sheen + (1 - out.sheen) * base);
}

}  // namespace covtrace
