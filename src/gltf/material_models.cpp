/// Choice of the models that take the place of glTF's own, which is a mixture of metal and
/// dielectric under a clear coat.
#include <algorithm>
#include <cmath>

#include "gltf/material_builder.h"

namespace covtrace::gltf {
namespace {

using Channel = ImageTexture::Channel;

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
    return m;
}

ConductorMaterial MaterialBuilder::metal() const {
    ConductorMaterial m;
    m.reflectance = base_;
    m.u_roughness = widths_.u;
    m.v_roughness = widths_.v;
    m.remap_roughness = false;
    return m;
}

void MaterialBuilder::read_clearcoat() {
    const auto* e = extension(material_.extensions, "KHR_materials_clearcoat");
    if (!e) return;
    const std::string place = in("KHR_materials_clearcoat");
    Clearcoat coat;
    coat.factor = static_cast<float>(number(document_, *e, "clearcoatFactor", 0, 0, 1, place));
    if (coat.factor == 0) return;
    coat.amount = textures_.channel(use(texture_info(document_, *e, "clearcoatTexture", place)),
                                    Channel::red, coat.factor, place + ".clearcoatTexture");
    const auto rough =
        static_cast<float>(number(document_, *e, "clearcoatRoughnessFactor", 0, 0, 1, place));
    coat.alpha = squared(use(texture_info(document_, *e, "clearcoatRoughnessTexture", place)),
                         Channel::green, rough, place + ".clearcoatRoughnessTexture");
    clearcoat_ = coat;
    warn(
        "KHR_materials_clearcoat: a coated metal or a diffuse base under the clear coat "
        "takes its place, in the share of the coat");
}

MaterialBuilder::Coatable MaterialBuilder::coatable(MaterialId plain,
                                                    decltype(MaterialDescription::value) coated) {
    return {plain, clearcoat_ ? add(std::move(coated)) : -1};
}

MaterialBuilder::Coatable MaterialBuilder::mixed(Coatable a, Coatable b, TextureId amount) {
    return {mix(a.plain, b.plain, amount), clearcoat_ ? mix(a.coated, b.coated, amount) : -1};
}

MaterialBuilder::Coatable MaterialBuilder::metal_surface() {
    CoatedConductorMaterial coated;
    coated.conductor = metal();
    coated.u_roughness = coated.v_roughness = clearcoat_ ? clearcoat_->alpha : -1;
    coated.thickness = clearcoat_ ? textures_.constant(0) : -1;
    coated.remap_roughness = false;
    return coatable(add(metal()), coated);
}

MaterialBuilder::Coatable MaterialBuilder::opaque_dielectric() {
    // The clear coat's border takes the place of the surface's own and of its tint.
    CoatedDiffuseMaterial coated =
        dielectric(clearcoat_ ? Widths{clearcoat_->alpha, clearcoat_->alpha} : widths_);
    coated.normal_reflectance = coated.coat_weight = -1;
    return coatable(add(dielectric(widths_)), coated);
}

MaterialId MaterialBuilder::glass() {
    const auto* volume = extension(material_.extensions, "KHR_materials_volume");
    const bool has_volume = volume && number(document_, *volume, "thicknessFactor", 0, 0, 1e30,
                                             in("KHR_materials_volume")) > 0;
    const bool is_rough =
        pbr_.metallicRoughnessTexture.index >= 0 || pbr_.roughnessFactor > kClearRoughness;
    if (has_volume) read_absorption(*volume);
    if (border_.normal_reflectance >= 0 || border_.weight >= 0)
        warn(
            "KHR_materials_specular: of a surface that transmits light, textures are left out and "
            "colours become their mean");
    if (!has_volume && !is_rough) return add(ThinDielectricMaterial{border_.mean_eta, base_});
    if (!has_volume)
        warn(
            "KHR_materials_transmission: a rough surface without KHR_materials_volume is "
            "rendered as the rough border of a solid body, which refracts");
    DielectricMaterial m;
    m.eta = border_.mean_eta;
    m.u_roughness = widths_.u;
    m.v_roughness = widths_.v;
    m.remap_roughness = false;
    m.transmittance = base_;
    return add(m);
}

void MaterialBuilder::read_absorption(const tinygltf::Value& volume) {
    const std::string place = in("KHR_materials_volume");
    const auto kept = numbers<3>(document_, volume, "attenuationColor", {1, 1, 1}, 0, place);
    const double distance =
        number(document_, volume, "attenuationDistance", 1e30, 1e-9, 1e30, place);
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

MaterialBuilder::Coatable MaterialBuilder::dielectric_surface() {
    const auto* e = extension(material_.extensions, "KHR_materials_transmission");
    const std::string place = in("KHR_materials_transmission");
    const double factor = e ? number(document_, *e, "transmissionFactor", 0, 0, 1, place) : 0.0;
    if (factor == 0) return opaque_dielectric();
    const auto info = use(texture_info(document_, *e, "transmissionTexture", place));
    const MaterialId clear = glass();
    // The glass has a border of its own, which shines like a coat.
    const Coatable transmitting{clear, clear};
    if (factor == 1 && info.index < 0) return transmitting;
    return mixed(opaque_dielectric(), transmitting,
                 textures_.channel(info, Channel::red, static_cast<float>(factor),
                                   place + ".transmissionTexture"));
}

MaterialBuilder::Coatable MaterialBuilder::metals_and_others(const TextureUse& texture,
                                                             float metallic) {
    read_clearcoat();
    if (metallic == 0) return dielectric_surface();
    if (metallic == 1 && texture.index < 0) return metal_surface();
    const Coatable other = dielectric_surface(), metal = metal_surface();
    return mixed(
        other, metal,
        textures_.channel(texture, Channel::blue, metallic, pbr("metallicRoughnessTexture")));
}

MaterialId MaterialBuilder::with_clearcoat(Coatable surface) {
    if (!clearcoat_) return surface.plain;
    return mix(surface.plain, surface.coated, clearcoat_->amount);
}

}  // namespace covtrace::gltf
