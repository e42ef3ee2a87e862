#include "shading/material.h"

#include <bit>
#include <utility>

#include "colour/colour_grid.h"
#include "core/hash.h"
#include "shading/material_bsdf.h"
#include "shading/material_inputs.h"
#include "shading/material_layers.h"

namespace covtrace {
namespace {

/// The middle of a texture, where parameters that may not vary are read.
constexpr TexturePoint kMiddle{{0.5f, 0.5f}, {}, {}};

/// Fixes the value of a colour that no texture varies.
void settle(MaterialColour& c, const TextureStore& textures) {
    if (c.texture >= 0 && !textures.is_constant(c.texture)) return;
    if (c.texture >= 0) c.fixed = c.scale * textures.eval(c.texture, kMiddle);
    c.texture = -1;
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
    if (m.normal_reflectance >= 0 || m.coat_weight >= 0 || m.film || m.multiple_scattering)
        material.tables.white = &coats_.get(kWhiteIndex, 0);
    if (!m.scatters_in_gap() && m.thickness >= 0 && !textures.is_constant(m.thickness))
        warnings_.push_back({where,
                             "coateddiffuse: \"thickness\" can't be textured; its value at (u, v) "
                             "= (0.5, 0.5) is used everywhere"});
}

void MaterialStore::prepare(const SubsurfaceMaterial& m, Material& material,
                            const TextureStore& textures) {
    prepare(m.border, material, textures);
}

void MaterialStore::prepare(const CoatedConductorMaterial& m, Material& material,
                            const TextureStore& textures) {
    prepare(m.conductor, material, textures);
}

void MaterialStore::prepare(const ConductorMaterial& m, Material& material, const TextureStore&) {
    if (m.multiple_scattering) material.tables.white = &coats_.get(kWhiteIndex, 0);
}

void MaterialStore::prepare(const DielectricMaterial& m, Material& material,
                            const TextureStore& textures) {
    if (!m.multiple_scattering) return;
    const float eta = refractive_index(m.eta);
    material.tables.from_outside = &coats_.get(eta, 0);
    material.tables.from_inside = &coats_.get(1 / eta, 0);
    if (!m.film) return;
    std::optional<float> thickness;
    if (m.film->thickness < 0 || textures.is_constant(m.film->thickness))
        thickness = film_thickness(*m.film, textures, kMiddle);
    material.tables.under_film =
        &films_.get(eta, refractive_index(m.film->eta), thickness, material.description.where);
}

void MaterialStore::prepare(const ThinDielectricMaterial& m, Material& material,
                            const TextureStore&) {
    if (m.u_roughness >= 0 || m.v_roughness >= 0)
        material.tables.white = &coats_.get(kWhiteIndex, 0);
}

void MaterialStore::prepare(const MeasuredMaterial& m, Material& material, const TextureStore&) {
    material.tables.measured = &measured_.try_emplace(m.brdf.get(), *m.brdf).first->second;
}

const GapSpectrum* MaterialStore::gap_spectrum(TextureId albedo, const TextureStore& textures,
                                               const MaterialColour* base,
                                               const IlluminantAdaptation& light) {
    if (!textures.is_constant(albedo)) return nullptr;
    const Rgb colour = clamp_to_unit(textures.eval(albedo, kMiddle));
    const bool has_base = base && base->texture < 0;
    if (is_grey(colour) && (!has_base || is_grey(clamp_to_unit(base->fixed)))) return nullptr;
    GapSpectrum spectrum{ColourBands(light), band_values(colour), {}, has_base};
    if (has_base) spectrum.base = band_values(base->fixed);
    return gaps_.emplace_back(std::make_unique<const GapSpectrum>(spectrum)).get();
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
        if (const auto* m = std::get_if<CoatedDiffuseMaterial>(&description.value);
            m && m->scatters_in_gap())
            material.tables.gap =
                gap_spectrum(m->albedo, textures, &material.colours.reflectance, adaptation);
        if (const auto* m = std::get_if<CoatedConductorMaterial>(&description.value);
            m && m->albedo >= 0)
            material.tables.gap = gap_spectrum(m->albedo, textures, nullptr, adaptation);
        for (MaterialColour* c : {&material.colours.reflectance, &material.colours.transmittance})
            c->fixed = adaptation(c->fixed);
        const MaterialValues at_middle{textures, kMiddle, material.colours, adaptation_, powers_};
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
        material.is_constant = is_constant(description, textures);
        if (!material.is_constant) continue;
        material.constant = make_bsdf(description, at_middle, material.tables);
        MaterialValues regularized = at_middle;
        regularized.lobes = Lobes::regularized;
        if (scene.regularizes)
            material.constant_regularized = make_bsdf(description, regularized, material.tables);
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
        const TexturePoint at{hit.uv, hit.position,   footprint_on(hit, w, width),
                              hit.ng, hit.vertices(), hit.facing};
        const MaterialValues values{textures, at, material.colours, adaptation_, powers_, lobes};
        found = make_bsdf(material.description, values, material.tables);
    }
    const auto place = [&hit] { return static_cast<uint32_t>(hash_of_position(hit, 0) >> 32); };
    if (auto* coated = std::get_if<CoatedConductorBsdf>(&found))
        coated->place = place();
    else if (auto* hazy = std::get_if<HazyDiffuseBsdf>(&found))
        hazy->place = place();
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
        const float amount = textures.eval_float(
            mix.amount, {hit.uv, hit.position, {}, hit.ng, hit.vertices(), hit.facing});
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
    // The light of a body enters it and leaves it
    const bool is_body = std::holds_alternative<SubsurfaceMaterial>(description(id).value);
    return {c.reflectance.texture, is_body ? c.reflectance.texture : c.transmittance.texture};
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
