#include "shading/material_inputs.h"

#include <algorithm>
#include <initializer_list>

namespace covtrace {

namespace {

constexpr float kDefaultTransmission = 0.25f;  // also the reflectance of what transmits

using TextureIds = std::initializer_list<TextureId>;

bool all_constant(const TextureStore& textures, TextureIds ids) {
    return std::all_of(ids.begin(), ids.end(),
                       [&](TextureId id) { return id < 0 || textures.is_constant(id); });
}

bool is_constant(const TextureStore& t, const std::optional<ThinFilmDescription>& film) {
    return !film || all_constant(t, {film->weight, film->thickness});
}

bool is_constant(const TextureStore& t, const DiffuseMaterial& m) {
    return all_constant(t, {m.reflectance});
}
bool is_constant(const TextureStore& t, const ConductorMaterial& m) {
    return is_constant(t, m.film) &&
           all_constant(t, {m.eta, m.k, m.reflectance, m.edge_tint, m.u_roughness, m.v_roughness});
}
bool is_constant(const TextureStore& t, const DielectricMaterial& m) {
    return is_constant(t, m.film) &&
           all_constant(t, {m.u_roughness, m.v_roughness, m.transmittance});
}
bool is_constant(const TextureStore& t, const CoatedDiffuseMaterial& m) {
    if (m.scatters_in_gap() && !all_constant(t, {m.thickness, m.g, m.albedo})) return false;
    return is_constant(t, m.film) && all_constant(t, {m.reflectance, m.u_roughness, m.v_roughness,
                                                      m.normal_reflectance, m.coat_weight});
}
bool is_constant(const TextureStore& t, const SubsurfaceMaterial& m) {
    return is_constant(t, m.border) &&
           all_constant(t, {m.mean_free_path, m.absorption, m.scattering, m.g});
}
bool is_constant(const TextureStore& t, const DiffuseTransmissionMaterial& m) {
    return all_constant(t, {m.reflectance, m.transmittance});
}
bool is_constant(const TextureStore& t, const CoatedConductorMaterial& m) {
    return is_constant(t, m.conductor) &&
           all_constant(t, {m.u_roughness, m.v_roughness, m.thickness, m.g, m.albedo});
}
bool is_constant(const TextureStore& t, const ThinDielectricMaterial& m) {
    return is_constant(t, m.film) &&
           all_constant(t, {m.transmittance, m.u_roughness, m.v_roughness});
}
bool is_constant(const TextureStore&, const InterfaceMaterial&) {
    return true;
}
bool is_constant(const TextureStore&, const MeasuredMaterial&) {
    return true;
}
bool is_constant(const TextureStore& t, const HairMaterial& m) {
    return all_constant(t, {m.absorption, m.reflectance, m.eumelanin, m.pheomelanin, m.beta_m,
                            m.beta_n, m.alpha, m.eta, m.coat});
}
bool is_constant(const TextureStore& t, const UnlitMaterial& m) {
    return all_constant(t, {m.colour});
}
bool are_layers_constant(const TextureStore& t, const MaterialDescription& m) {
    return (!m.sheen || all_constant(t, {m.sheen->colour, m.sheen->alpha})) &&
           (!m.clearcoat ||
            all_constant(t, {m.clearcoat->weight, m.clearcoat->alpha, m.clearcoat->tint}));
}

/// The colours of a model as the file gives them; `fixed` where it gives none.
MaterialColours colours(const DiffuseMaterial& m) {
    return {{m.reflectance, 1, Rgb(kDefaultReflectance)}, {}};
}
MaterialColours colours(const ConductorMaterial& m) {
    return {{m.reflectance, 1, Rgb(1)}, {}};
}
MaterialColours colours(const DielectricMaterial& m) {
    return {{}, {m.transmittance, 1, Rgb(1)}};
}
MaterialColours colours(const CoatedDiffuseMaterial& m) {
    return {{m.reflectance, 1, Rgb(kDefaultReflectance)}, {}};
}
MaterialColours colours(const SubsurfaceMaterial& m) {
    return colours(m.border);
}
MaterialColours colours(const DiffuseTransmissionMaterial& m) {
    const Rgb otherwise = m.scale * Rgb(kDefaultTransmission);
    return {{m.reflectance, m.scale, otherwise}, {m.transmittance, m.scale, otherwise}};
}
MaterialColours colours(const CoatedConductorMaterial& m) {
    return colours(m.conductor);
}
MaterialColours colours(const ThinDielectricMaterial& m) {
    return {{}, {m.transmittance, 1, Rgb(1)}};
}
MaterialColours colours(const HairMaterial& m) {
    return {{m.reflectance, 1, Rgb(kDefaultReflectance)}, {}};
}
/// All other models give none.
template <typename Model>
MaterialColours colours(const Model&) {
    return {};
}

}  // namespace

bool is_constant(const MaterialDescription& m, const TextureStore& textures) {
    return std::visit([&](const auto& model) { return is_constant(textures, model); }, m.value) &&
           are_layers_constant(textures, m);
}

MaterialColours colours_of(const MaterialDescription& m) {
    return std::visit([](const auto& model) { return colours(model); }, m.value);
}

}  // namespace covtrace
