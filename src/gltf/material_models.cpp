/// Choice of the models that take the place of glTF's own, which is a mixture of metal and
/// dielectric.
#include <algorithm>
#include <cmath>

#include "gltf/material_builder.h"
#include "scene/dispersion.h"

namespace covtrace::gltf {
namespace {

using Channel = ImageTexture::Channel;

/// The dispersion of a glass of index `eta` at the Fraunhofer line d, by the specification:
/// Cauchy's formula, such that the index falls by strength (eta - 1) / 20 from the line F to the
/// line C.
std::shared_ptr<const Dispersion> fraunhofer_dispersion(float eta, float strength) {
    constexpr float kAbbeOfOne = 20;     // Abbe number of strength 1
    constexpr float kSquare = 523655;    // nm², 1 / (F^-2 - C^-2)
    constexpr float kOfLineD = 1.5168f;  // kSquare / d²
    const float per_step = (eta - 1) * strength / kAbbeOfOne;
    return dispersion_of(
        [&](float nm) { return std::max(eta + per_step * (kSquare / (nm * nm) - kOfLineD), 1.0f); },
        eta);
}

}  // namespace

CoatedDiffuseMaterial MaterialBuilder::dielectric(Widths widths) const {
    CoatedDiffuseMaterial m;
    m.reflectance = base_;
    m.u_roughness = widths.u;
    m.v_roughness = widths.v;
    m.remap_roughness = false;
    m.eta = border_.eta;
    m.reflects_through_coat = true;
    m.normal_reflectance = border_.normal_reflectance;
    m.coat_weight = border_.weight;
    m.coat_dims_base = border_.dims_base;
    m.film = film_;
    m.multiple_scattering = border_.normal_reflectance < 0 && border_.weight < 0 && !film_;
    return m;
}

ConductorMaterial MaterialBuilder::metal() const {
    ConductorMaterial m;
    m.reflectance = base_;
    m.u_roughness = widths_.u;
    m.v_roughness = widths_.v;
    m.remap_roughness = false;
    m.multiple_scattering = true;
    m.film = film_;
    return m;
}

MaterialId MaterialBuilder::glass() {
    const auto* volume = extension(material_.extensions, "KHR_materials_volume");
    const bool has_volume = volume && has_thickness(*volume);
    const bool is_rough =
        pbr_.metallicRoughnessTexture.index >= 0 || pbr_.roughnessFactor > kClearRoughness;
    if (has_volume) read_absorption(*volume);
    if (border_.normal_reflectance >= 0 || border_.weight >= 0)
        warn(
            "KHR_materials_specular: of a surface that transmits light, textures are left out and "
            "colours become their mean");
    if (!has_volume) {
        ThinDielectricMaterial pane{border_.mean_eta, base_};
        if (is_rough) {
            pane.u_roughness = widths_.u;
            pane.v_roughness = widths_.v;
        }
        pane.film = film_;
        return add(pane);
    }
    DielectricMaterial m;
    m.eta = border_.mean_eta;
    if (const auto* dispersion = extension(material_.extensions, "KHR_materials_dispersion"))
        m.dispersion = fraunhofer_dispersion(m.eta, number(document_, *dispersion, "dispersion", 0,
                                                           0, 1e3, in("KHR_materials_dispersion")));
    m.u_roughness = widths_.u;
    m.v_roughness = widths_.v;
    m.remap_roughness = false;
    m.multiple_scattering = true;
    m.transmittance = base_;
    m.film = film_;
    return add(m);
}

void MaterialBuilder::read_absorption(const tinygltf::Value& volume) {
    const std::string place = in("KHR_materials_volume");
    const auto kept = numbers<3>(document_, volume, "attenuationColor", {1, 1, 1}, 0, place);
    // Some writers say 0 where they mean that nothing is absorbed, which readers take as such.
    const double said = number(document_, volume, "attenuationDistance", kAny, 0, kAny, place);
    constexpr double kLeastDistance = 1e-9;
    const double distance = said > 0 ? std::max(said, kLeastDistance) : kAny;
    Rgb sigma;
    for (int c = 0; c < 3; ++c) {
        constexpr double kLeast = 1e-6;  // darker than any display shows
        const double k = std::clamp(kept[static_cast<size_t>(c)], kLeast, 1.0);
        sigma[c] = static_cast<float>(-std::log(k) / distance);
    }
    if (max_component(sigma) < 1e-12f) return;
    scene_.media.push_back({material_.name, sigma, Rgb(0), Rgb(0), 0, document_.place(place_)});
    surface_.inside = static_cast<MediumId>(scene_.media.size() - 1);
}

MaterialId MaterialBuilder::opaque_dielectric() {
    const MaterialId reflecting = add(dielectric(widths_));
    const auto* e = extension(material_.extensions, kDiffuseTransmission);
    const std::string place = in(kDiffuseTransmission);
    const float factor = e ? share(*e, "diffuseTransmissionFactor", 0, place) : 0;
    if (factor == 0) return reflecting;
    const auto* volume = extension(material_.extensions, "KHR_materials_volume");
    if (volume && has_thickness(*volume)) read_absorption(*volume);
    const Rgb tint =
        rgb(numbers<3>(document_, *e, "diffuseTransmissionColorFactor", {1, 1, 1}, 0, place));
    DiffuseTransmissionMaterial m;
    m.reflectance = textures_.constant(0);
    m.transmittance =
        textures_.colour(use(texture_info(document_, *e, "diffuseTransmissionColorTexture", place)),
                         tint, place + ".diffuseTransmissionColorTexture");
    const auto amount = use(texture_info(document_, *e, "diffuseTransmissionTexture", place));
    return mix(
        reflecting, add(m),
        textures_.channel(amount, Channel::alpha, factor, place + ".diffuseTransmissionTexture"));
}

bool MaterialBuilder::has_thickness(const tinygltf::Value& volume) const {
    return number(document_, volume, "thicknessFactor", 0, 0, 1e30, in("KHR_materials_volume")) > 0;
}

MaterialId MaterialBuilder::dielectric_surface() {
    const auto* e = extension(material_.extensions, "KHR_materials_transmission");
    const std::string place = in("KHR_materials_transmission");
    const float factor = e ? share(*e, "transmissionFactor", 0, place) : 0;
    if (factor == 0) return opaque_dielectric();
    const auto info = use(texture_info(document_, *e, "transmissionTexture", place));
    const MaterialId clear = glass();
    if (factor == 1 && info.index < 0) return clear;
    return mix(opaque_dielectric(), clear,
               textures_.channel(info, Channel::red, factor, place + ".transmissionTexture"));
}

MaterialId MaterialBuilder::metals_and_others(const TextureUse& texture, float metallic) {
    if (metallic == 0) return dielectric_surface();
    if (metallic == 1 && texture.index < 0) return add(metal());
    const MaterialId other = dielectric_surface(), metals = add(metal());
    return mix(
        other, metals,
        textures_.channel(texture, Channel::blue, metallic, pbr("metallicRoughnessTexture")));
}

}  // namespace covtrace::gltf
