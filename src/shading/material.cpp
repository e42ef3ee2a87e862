#include "shading/material.h"

#include <bit>
#include <utility>

#include "bsdf/hair.h"
#include "bsdf/multiple_scattering.h"
#include "core/hash.h"
#include "shading/material_inputs.h"
#include "shading/material_layers.h"

namespace covtrace {
namespace {

Rgb sqrt(Rgb c) {
    return {std::sqrt(c.r), std::sqrt(c.g), std::sqrt(c.b)};
}

/// A GGX width as pbrt-v4 regularizes it: twice as wide, within limits; wide ones stay.
float regularized(float alpha) {
    constexpr float kNarrowest = 0.1f, kWidest = 0.3f;
    return alpha < kWidest ? std::clamp(2 * alpha, kNarrowest, kWidest) : alpha;
}

/// Values of a material's textures at one place; `fallback` where the file gives none.
struct Values {
    const TextureStore& textures;
    TexturePoint at;
    const MaterialColours& colours;
    const AdaptationTable& adaptation;
    const ReflectancePowersTable& powers;
    Lobes lobes = Lobes::as_given;
    Rgb reflectance() const { return colour(colours.reflectance); }
    ReflectancePowers powers_of_reflectance() const {
        const MaterialColour& c = colours.reflectance;
        return c.texture < 0 ? colours.fixed_powers
                             : powers(c.scale * textures.eval(c.texture, at));
    }
    Rgb transmittance() const { return colour(colours.transmittance); }
    /// A reflectance or transmittance in [0, 1]; NaN becomes 0, so that a broken texel can't
    /// spread.
    Rgb colour(const MaterialColour& c) const {
        return c.texture < 0 ? c.fixed : adaptation(c.scale * textures.eval(c.texture, at));
    }
    Rgb spectrum(TextureId id, float fallback) const {
        return id < 0 ? Rgb(fallback) : textures.eval(id, at);
    }
    float number(TextureId id, float fallback) const {
        return id < 0 ? fallback : textures.eval_float(id, at);
    }
    CoatTint tint(const CoatedDiffuseMaterial& m, const CoatTable* white) const {
        return {share(spectrum(m.normal_reflectance, sqr((m.eta - 1) / (m.eta + 1)))),
                share(number(m.coat_weight, 1)), white};
    }
    template <typename M>
    Vec2 alphas(const M& m) const {
        const Vec2 a =
            ggx_alphas(number(m.u_roughness, 0), number(m.v_roughness, 0), m.remap_roughness);
        return lobes == Lobes::regularized ? Vec2{regularized(a.x), regularized(a.y)} : a;
    }
};

/// The index to use: where the file's spectrum doesn't reach the given one is 0, for which pbrt
/// takes 1.
float refractive_index(float eta) {
    return eta > 0 ? eta : 1;
}

using Tables = MaterialTables;

constexpr float kDefaultThickness = 0.01f;

Bsdf make(const DiffuseMaterial&, const Values& v, const Tables&) {
    return DiffuseBsdf{v.reflectance()};
}

/// A metal whose light is reflected once.
ConductorBsdf metal(const ConductorMaterial& m, const Values& v) {
    const Vec2 alpha = v.alphas(m);
    if (m.reflectance < 0)
        return ConductorBsdf{v.spectrum(m.eta, 1), v.spectrum(m.k, 1), alpha.x, alpha.y};
    Rgb r = v.reflectance();
    if (m.edge != ConductorMaterial::Edge::of_index) {
        ConductorBsdf b{Rgb(1), Rgb(0), alpha.x, alpha.y};
        b.schlick = m.edge == ConductorMaterial::Edge::schlick
                        ? metal_of_edge(r, share(v.spectrum(m.edge_tint, 1)))
                        : SchlickMetal<Rgb>{r, r, Rgb(0)};
        return b;
    }
    // The metal has eta = 1 and the k that reflects r at normal incidence.
    constexpr float kMost = 0.9999f;
    r = {std::min(r.r, kMost), std::min(r.g, kMost), std::min(r.b, kMost)};
    return ConductorBsdf{Rgb(1), 2 * sqrt(r) / sqrt(Rgb(1) - r), alpha.x, alpha.y};
}

Bsdf make(const ConductorMaterial& m, const Values& v, const Tables& tables) {
    const ConductorBsdf b = metal(m, v);
    return m.multiple_scattering ? with_multiple_scattering(b, *tables.white) : b;
}

Bsdf make(const DielectricMaterial& m, const Values& v, const Tables& tables) {
    const Vec2 alpha = v.alphas(m);
    const DielectricBsdf b{refractive_index(m.eta), alpha.x, alpha.y,
                           m.transmittance < 0 ? Rgb(1) : v.transmittance(), m.dispersion.get()};
    return m.multiple_scattering
               ? with_multiple_scattering(b, *tables.from_outside, *tables.from_inside)
               : b;
}

Bsdf make(const CoatedDiffuseMaterial& m, const Values& v, const Tables& tables) {
    const Vec2 alpha = v.alphas(m);
    if (m.reflects_through_coat) {
        Rgb reflectance = v.reflectance();
        if (m.multiple_scattering)
            return make_coated_total(*tables.coat, reflectance, alpha.x, alpha.y, {}, tables.white);
        CoatTint tint;
        if (tables.white) {
            tint = v.tint(m, tables.white);
            if (m.coat_dims_base) reflectance *= 1 - max_component(tint.normal_reflectance);
        }
        return make_coated_total(*tables.coat, reflectance, alpha.x, alpha.y, tint);
    }
    // The number of bounces is half of pbrt's depth, whose walk meets the base at every second of
    // its steps.
    return make_coated_diffuse(*tables.coat, v.powers_of_reflectance(), alpha.x, alpha.y,
                               (m.max_depth + 1) / 2);
}

Bsdf make(const DiffuseTransmissionMaterial&, const Values& v, const Tables&) {
    return DiffuseTransmissionBsdf{v.reflectance(), v.transmittance()};
}

Bsdf make(const CoatedConductorMaterial& m, const Values& v, const Tables& tables) {
    const Vec2 coat = v.alphas(m);
    CoatedConductorBsdf b;
    b.coat = {refractive_index(m.eta), coat.x, coat.y};
    b.metal = metal(m.conductor, v);
    b.metal.eta *= 1 / b.coat.eta;
    b.metal.k *= 1 / b.coat.eta;
    if (m.conductor.multiple_scattering) b.metal = with_multiple_scattering(b.metal, *tables.white);
    b.thickness = std::max(0.0f, v.number(m.thickness, kDefaultThickness));
    // The number of bounces is half of pbrt's depth, whose walk meets the metal at every second of
    // its steps.
    b.bounces = std::max(1, (m.max_depth + 1) / 2);
    b.samples = std::max(1, m.samples);
    return b;
}

Bsdf make(const ThinDielectricMaterial& m, const Values& v, const Tables&) {
    return ThinDielectricBsdf{refractive_index(m.eta),
                              m.transmittance < 0 ? Rgb(1) : v.transmittance()};
}

Bsdf make(const InterfaceMaterial&, const Values&, const Tables&) {
    return InterfaceBsdf{};
}

Bsdf make(const MeasuredMaterial&, const Values&, const Tables& tables) {
    return MeasuredBsdf{tables.measured};
}

Bsdf make(const UnlitMaterial& m, const Values& v, const Tables&) {
    return UnlitBsdf{v.spectrum(m.colour, 1), m.two_sided};
}

/// Absorption in a strand, by the first description that is given.
Rgb hair_absorption(const HairMaterial& m, const Values& v, float beta_n) {
    const auto at_least_0 = [](float x) { return x > 0 ? x : 0.0f; };
    if (m.absorption >= 0) {
        const Rgb a = v.spectrum(m.absorption, 0);
        return {at_least_0(a.r), at_least_0(a.g), at_least_0(a.b)};
    }
    if (m.reflectance >= 0) return absorption_of_reflectance(share(v.reflectance()), beta_n);
    constexpr float kDefaultEumelanin = 1.3f;
    if (m.eumelanin < 0 && m.pheomelanin < 0) return absorption_of_pigments(kDefaultEumelanin, 0);
    return absorption_of_pigments(at_least_0(v.number(m.eumelanin, 0)),
                                  at_least_0(v.number(m.pheomelanin, 0)));
}

Bsdf make(const HairMaterial& m, const Values& v, const Tables&) {
    HairShape shape;
    shape.beta_m = share(v.number(m.beta_m, shape.beta_m));
    shape.beta_n = share(v.number(m.beta_n, shape.beta_n));
    shape.alpha = v.number(m.alpha, shape.alpha);
    shape.eta = v.number(m.eta, shape.eta);
    shape.coat = share(v.number(m.coat, shape.coat));
    return make_hair(shape, hair_absorption(m, v, shape.beta_n));
}

/// The middle of a texture, where parameters that may not vary are read.
constexpr TexturePoint kMiddle{{0.5f, 0.5f}, {}, {}};

/// Fixes the value of a colour that no texture varies.
void settle(MaterialColour& c, const TextureStore& textures) {
    if (c.texture >= 0 && !textures.is_constant(c.texture)) return;
    if (c.texture >= 0) c.fixed = c.scale * textures.eval(c.texture, kMiddle);
    c.texture = -1;
}

void warn_of_gap(TextureId gap_albedo, const char* type, const SourceLocation& where,
                 const TextureStore& textures, Warnings& warnings) {
    if (gap_albedo >= 0 &&
        !(textures.is_constant(gap_albedo) && is_black(textures.eval(gap_albedo, kMiddle))))
        warnings.push_back({where, std::string(type) +
                                       ": scattering between coat and base (\"albedo\") is not "
                                       "supported; the gap is rendered clear"});
}

/// Random bits that are the same whenever a place is met, and others for each `key`.
uint64_t hash_of_position(const SurfaceHit& hit, uint64_t key) {
    for (const float c : {hit.position.x, hit.position.y, hit.position.z})
        key = hash_combine(key, std::bit_cast<uint32_t>(c));
    return key;
}

}  // namespace

Frame shading_frame(const SurfaceHit& hit) {
    return Frame::from_z_x(hit.ns, hit.tangent);
}

Vec2 ggx_alphas(float u_roughness, float v_roughness, bool remap) {
    constexpr float kSmoothBelow = 1e-3f, kSmallest = 1e-4f;
    const Vec2 a = remap ? Vec2{safe_sqrt(u_roughness), safe_sqrt(v_roughness)}
                         : Vec2{u_roughness, v_roughness};
    if (!(std::max(a.x, a.y) >= kSmoothBelow)) return {};
    return {std::max(kSmallest, a.x), std::max(kSmallest, a.y)};
}

void MaterialStore::prepare(const CoatedDiffuseMaterial& m, Material& material,
                            const TextureStore& textures) {
    float thickness = 0;
    if (!m.reflects_through_coat)
        thickness = m.thickness < 0 ? kDefaultThickness
                                    : std::max(0.0f, textures.eval_float(m.thickness, kMiddle));
    const SourceLocation& where = material.description.where;
    material.tables.coat = m.multiple_scattering ? &coats_.get_bouncing(refractive_index(m.eta))
                                                 : &coats_.get(refractive_index(m.eta), thickness);
    if (m.normal_reflectance >= 0 || m.coat_weight >= 0 || m.multiple_scattering)
        material.tables.white = &coats_.get(kWhiteIndex, 0);
    warn_of_gap(m.albedo, "coateddiffuse", where, textures, warnings_);
    if (m.thickness >= 0 && !textures.is_constant(m.thickness))
        warnings_.push_back({where,
                             "coateddiffuse: \"thickness\" can't be textured; its value at (u, v) "
                             "= (0.5, 0.5) is used everywhere"});
}

void MaterialStore::prepare(const CoatedConductorMaterial& m, Material& material,
                            const TextureStore& textures) {
    warn_of_gap(m.albedo, "coatedconductor", material.description.where, textures, warnings_);
    prepare(m.conductor, material, textures);
}

void MaterialStore::prepare(const ConductorMaterial& m, Material& material, const TextureStore&) {
    if (m.multiple_scattering) material.tables.white = &coats_.get(kWhiteIndex, 0);
}

void MaterialStore::prepare(const DielectricMaterial& m, Material& material, const TextureStore&) {
    if (!m.multiple_scattering) return;
    const float eta = refractive_index(m.eta);
    material.tables.from_outside = &coats_.get(eta, 0);
    material.tables.from_inside = &coats_.get(1 / eta, 0);
}

void MaterialStore::prepare(const MeasuredMaterial& m, Material& material, const TextureStore&) {
    material.tables.measured = &measured_.try_emplace(m.brdf.get(), *m.brdf).first->second;
}

MaterialStore::MaterialStore(const SceneDescription& scene, const TextureStore& textures,
                             const IlluminantAdaptation& adaptation) {
    materials_.reserve(scene.materials.size());
    bool any_varies = false, any_varies_below_coat = false;
    for (const MaterialDescription& description : scene.materials) {
        Material& material = materials_.emplace_back();
        material.description = description;
        material.colours = colours_of(description);
        for (MaterialColour* c : {&material.colours.reflectance, &material.colours.transmittance}) {
            settle(*c, textures);
            any_varies = any_varies || c->texture >= 0;
        }
        if (const auto* m = std::get_if<CoatedDiffuseMaterial>(&description.value);
            m && !m->reflects_through_coat) {
            if (material.colours.reflectance.texture >= 0)
                any_varies_below_coat = true;
            else
                material.colours.fixed_powers =
                    reflectance_powers(material.colours.reflectance.fixed, adaptation);
        }
        for (MaterialColour* c : {&material.colours.reflectance, &material.colours.transmittance})
            c->fixed = adaptation(c->fixed);
        const Values at_middle{textures, kMiddle, material.colours, adaptation_, powers_};
        std::visit([&](const auto& m) { prepare(m, material, textures); }, description.value);
        if (description.sheen) {
            if (!sheen_) sheen_ = std::make_unique<const SheenTable>();
            material.tables.sheen = sheen_.get();
        }
        if (description.clearcoat && description.clearcoat->eta > 0)
            material.tables.clearcoat = &coats_.get(description.clearcoat->eta, 0);
        material.has_layers = covtrace::has_layers(description);
        if (description.mix)
            for (MaterialId part : description.mix->materials)
                material.has_layers = material.has_layers || has_layers(part);
        std::visit(
            [&](const auto& m) {
                material.is_constant = is_constant(description, textures);
                if (!material.is_constant) return;
                const auto made = [&](const Values& v) {
                    Bsdf bsdf = make(m, v, material.tables);
                    put_under_layers(bsdf, description, textures, v.at, material.tables);
                    return bsdf;
                };
                material.constant = made(at_middle);
                if (scene.regularizes)
                    material.constant_regularized =
                        made({textures, kMiddle, material.colours, adaptation_, powers_,
                              Lobes::regularized});
            },
            description.value);
    }
    if (any_varies) adaptation_ = AdaptationTable(adaptation);
    if (any_varies_below_coat) powers_ = ReflectancePowersTable(adaptation);
}

Bsdf MaterialStore::bsdf(MaterialId id, const SurfaceHit& hit, const TextureStore& textures, Vec3 w,
                         float width, Lobes lobes) const {
    if (id < 0) return DiffuseBsdf{Rgb(kDefaultReflectance)};
    const Material& material = materials_[static_cast<size_t>(id)];
    Bsdf found = lobes == Lobes::as_given ? material.constant : material.constant_regularized;
    if (!material.is_constant) {
        const TexturePoint at{hit.uv, hit.position, footprint_on(hit, w, width), hit.ng,
                              hit.vertices()};
        const Values values{textures, at, material.colours, adaptation_, powers_, lobes};
        found = std::visit([&](const auto& m) { return make(m, values, material.tables); },
                           material.description.value);
        put_under_layers(found, material.description, textures, at, material.tables);
    }
    if (auto* coated = std::get_if<CoatedConductorBsdf>(&found))
        coated->place = static_cast<uint32_t>(hash_of_position(hit, 0) >> 32);
    else if (auto* hair = std::get_if<HairBsdf>(&found))
        hair->offset = std::clamp(2 * hit.uv.y - 1, -1.0f, 1.0f);
    return found;
}

PlacedMaterial MaterialStore::at(MaterialId id, const SurfaceHit& hit,
                                 const TextureStore& textures) const {
    float weight = 1;
    while (id >= 0 && description(id).mix) {
        const MaterialMix& mix = *description(id).mix;
        weight *= mix.weight;
        const float amount =
            textures.eval_float(mix.amount, {hit.uv, hit.position, {}, hit.ng, hit.vertices()});
        const uint64_t h = hash_of_position(hit, static_cast<uint64_t>(id));
        id = mix.materials[to_unit_float(static_cast<uint32_t>(h >> 32)) < amount ? 1 : 0];
    }
    return {id, weight};
}

bool MaterialStore::turns_frame(MaterialId id) const {
    if (id < 0) return false;
    const MaterialDescription& d = description(id);
    return d.displacement >= 0 || d.normal_map >= 0 || d.tangent_direction >= 0 ||
           d.tangent_rotation != 0;
}

MaterialTextures MaterialStore::textures(MaterialId id) const {
    if (id < 0) return {};
    const MaterialColours& c = materials_[static_cast<size_t>(id)].colours;
    return {c.reflectance.texture, c.transmittance.texture};
}

bool MaterialStore::lets_light_pass(MaterialId id) const {
    if (id < 0) return false;
    const auto& model = materials_[static_cast<size_t>(id)].description.value;
    return std::holds_alternative<InterfaceMaterial>(model) ||
           std::holds_alternative<UnlitMaterial>(model);
}

Rgb MaterialStore::emission_share(MaterialId id, const TexturePoint& at, float cosine,
                                  const TextureStore& textures) const {
    if (!has_layers(id)) return Rgb(1);
    if (const auto& mix = description(id).mix) {
        const float amount = clamp01(textures.eval_float(mix->amount, at));
        return (1 - amount) * emission_share(mix->materials[0], at, cosine, textures) +
               amount * emission_share(mix->materials[1], at, cosine, textures);
    }
    return covtrace::emission_share(description(id), textures, at,
                                    materials_[static_cast<size_t>(id)].tables, cosine);
}

bool MaterialStore::turns_clearcoat(MaterialId id) const {
    return id >= 0 && description(id).clearcoat &&
           (description(id).clearcoat->normal_map >= 0 || turns_frame(id));
}

}  // namespace covtrace
