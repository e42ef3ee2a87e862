#include "gltf/material_builder.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gltf/extensions.h"

namespace covtrace::gltf {
namespace {

using Channel = ImageTexture::Channel;

/// Refractive index that stands for all larger ones: its border reflects 99.6 % at the normal, and
/// what is below it keeps more than rounding errors of the rest.
constexpr float kLargestIndex = 1000;
/// Amplitude that the border of that index reflects at the normal.
constexpr float kLargestRoot = (kLargestIndex - 1) / (kLargestIndex + 1);

/// Checks a number that the library leaves unchecked: refuses it outside of [least, most].
float in_range(const Document& document, double v, double least, double most,
               const std::string& place) {
    if (!(v >= least && v <= most))
        document.refuse(place, "expected a number from " + std::to_string(least) + " to " +
                                   std::to_string(most));
    return static_cast<float>(v);
}

Rgb colour(const Document& document, const std::vector<double>& v, size_t count, Rgb otherwise,
           const std::string& place) {
    if (v.empty()) return otherwise;
    if (v.size() != count) document.refuse(place, "expected " + std::to_string(count) + " numbers");
    return {in_range(document, v[0], 0, 1, place), in_range(document, v[1], 0, 1, place),
            in_range(document, v[2], 0, 1, place)};
}

tinygltf::TextureInfo plain_info(const tinygltf::NormalTextureInfo& normal) {
    tinygltf::TextureInfo info;
    info.index = normal.index;
    info.texCoord = normal.texCoord;
    info.extensions = normal.extensions;
    return info;
}

}  // namespace

Surface MaterialBuilder::build() {
    for (const auto& [name, unused] : material_.extensions)
        if (!is_supported(name)) warn("extension " + name + " is not supported and left out");
    choose_uv_set();
    base_factor_ = colour(document_, pbr_.baseColorFactor, 4, Rgb(1), pbr("baseColorFactor"));
    read_alpha();
    if (extension(material_.extensions, "KHR_materials_unlit")) {
        build_unlit();
        return surface_;
    }
    read_emission();
    read_normal_map();
    base_ = textures_.colour(use(pbr_.baseColorTexture), base_factor_, pbr("baseColorTexture"));
    const auto mr = use(pbr_.metallicRoughnessTexture);
    alpha_ = squared(mr, Channel::green,
                     in_range(document_, pbr_.roughnessFactor, 0, 1, pbr("roughnessFactor")),
                     pbr("metallicRoughnessTexture"));
    read_index();
    const float metallic = in_range(document_, pbr_.metallicFactor, 0, 1, pbr("metallicFactor"));
    surface_.material = with_clearcoat(metals_and_others(mr, metallic));
    return surface_;
}

MaterialId MaterialBuilder::add(decltype(MaterialDescription::value) model) {
    MaterialDescription m;
    m.name = material_.name;
    m.value = std::move(model);
    m.where = document_.place(place_);
    m.normal_map = normal_map_;
    m.normal_scale = normal_scale_;
    m.normal_map_follows_v = true;
    scene_.materials.push_back(std::move(m));
    return static_cast<MaterialId>(scene_.materials.size() - 1);
}

MaterialId MaterialBuilder::mix(MaterialId a, MaterialId b, TextureId amount) {
    const MaterialId id = add(DiffuseMaterial{});
    scene_.materials.back().mix = MaterialMix{{a, b}, amount};
    return id;
}

void MaterialBuilder::choose_uv_set() {
    const tinygltf::Value* transmission =
        extension(material_.extensions, "KHR_materials_transmission");
    const tinygltf::TextureInfo none;
    const tinygltf::TextureInfo transmitted =
        transmission ? texture_info(document_, *transmission, "transmissionTexture",
                                    in("KHR_materials_transmission"))
                     : none;
    for (const tinygltf::TextureInfo& info :
         {pbr_.baseColorTexture, pbr_.metallicRoughnessTexture, plain_info(material_.normalTexture),
          material_.emissiveTexture, transmitted}) {
        if (info.index < 0) continue;
        const int set = TextureReader::uv_set(document_, info, place_);
        if (surface_.uv_set < 0) surface_.uv_set = set;
    }
}

tinygltf::TextureInfo MaterialBuilder::use(const tinygltf::TextureInfo& info) {
    if (info.index < 0) return info;
    if (surface_.uv_set < 0) surface_.uv_set = TextureReader::uv_set(document_, info, place_);
    if (TextureReader::uv_set(document_, info, place_) != surface_.uv_set) {
        warn(
            "its textures use several sets of texture coordinates; those that don't use "
            "TEXCOORD_" +
            std::to_string(surface_.uv_set) + " are left out");
        return {};
    }
    return info;
}

TextureId MaterialBuilder::squared(const tinygltf::TextureInfo& info, Channel channel, float factor,
                                   const std::string& place) {
    if (info.index < 0) return textures_.constant(factor * factor);
    const TextureId r = textures_.channel(info, channel, factor, place);
    return textures_.product(r, r, false);
}

void MaterialBuilder::read_alpha() {
    const std::string& mode = material_.alphaMode;
    if (mode == "OPAQUE" || mode.empty()) return;
    const float factor =
        pbr_.baseColorFactor.size() == 4
            ? in_range(document_, pbr_.baseColorFactor[3], 0, 1, pbr("baseColorFactor"))
            : 1;
    const auto info = use(pbr_.baseColorTexture);
    const std::string place = pbr("baseColorTexture");
    if (mode == "MASK") {
        const float cutoff =
            in_range(document_, material_.alphaCutoff, 0, 1e30, place_ + ".alphaCutoff");
        if (factor < cutoff) {
            surface_.is_visible = false;  // alpha is at most the factor
        } else if (info.index >= 0 && cutoff > 0) {
            surface_.alpha = textures_.mask(info, cutoff / factor, place);
        }
    } else if (mode == "BLEND") {
        surface_.is_visible = factor > 0;
        if (info.index >= 0)
            surface_.alpha = textures_.channel(info, Channel::alpha, factor, place);
        else if (factor < 1)
            surface_.alpha = textures_.constant(factor);
    } else {
        document_.refuse(place_ + ".alphaMode", "expected OPAQUE, MASK or BLEND");
    }
}

void MaterialBuilder::emit(Rgb radiance, const tinygltf::TextureInfo& info,
                           const std::string& place) {
    AreaLightDescription light;
    light.radiance = radiance;
    light.two_sided = material_.doubleSided;
    light.where = document_.place(place_);
    if (info.index >= 0) light.image = textures_.colour(info, Rgb(1), place);
    surface_.emission = light;
}

void MaterialBuilder::build_unlit() {
    warn(
        "KHR_materials_unlit: an emitter of the base colour takes its place, which also "
        "lights what is near");
    surface_.material = add(DiffuseMaterial{textures_.constant(Rgb(0), true)});
    if (!is_black(base_factor_))
        emit(base_factor_, use(pbr_.baseColorTexture), pbr("baseColorTexture"));
}

void MaterialBuilder::read_emission() {
    const Rgb factor =
        colour(document_, material_.emissiveFactor, 3, Rgb(0), place_ + ".emissiveFactor");
    double strength = 1;
    if (const auto* e = extension(material_.extensions, "KHR_materials_emissive_strength"))
        strength = number(document_, *e, "emissiveStrength", 1, 0, 1e30,
                          in("KHR_materials_emissive_strength"));
    const Rgb radiance = factor * static_cast<float>(strength);
    if (is_black(radiance)) return;
    emit(radiance, use(material_.emissiveTexture), place_ + ".emissiveTexture");
    surface_.is_strong_light = max_component(radiance) > 1;
}

void MaterialBuilder::read_normal_map() {
    normal_map_ =
        textures_.linear(use(plain_info(material_.normalTexture)), place_ + ".normalTexture");
    normal_scale_ = in_range(document_, material_.normalTexture.scale, -1e6, 1e6,
                             place_ + ".normalTexture.scale");
}

void MaterialBuilder::read_index() {
    if (const auto* e = extension(material_.extensions, "KHR_materials_ior")) {
        constexpr double kAny = std::numeric_limits<double>::max();
        const double ior = number(document_, *e, "ior", 1.5, 0, kAny, in("KHR_materials_ior"));
        if (ior > 0 && ior < 1)
            document_.refuse(in("KHR_materials_ior"), "expected an ior of 0 or at least 1");
        // An ior of 0 stands for a border that reflects everything, as it does in the limit of
        // large ones.
        eta_ = ior > 0 ? static_cast<float>(std::min(ior, double(kLargestIndex))) : kLargestIndex;
    }
    const auto* specular = extension(material_.extensions, "KHR_materials_specular");
    if (!specular) return;
    const std::string place = in("KHR_materials_specular");
    const double factor = number(document_, *specular, "specularFactor", 1, 0, 1, place);
    const auto tint = numbers<3>(document_, *specular, "specularColorFactor", {1, 1, 1}, 0, place);
    if (specular->Has("specularTexture") || specular->Has("specularColorTexture") ||
        tint[0] != tint[1] || tint[1] != tint[2])
        warn("KHR_materials_specular: textures and colours are left out, their mean is used");
    // The index is that of a border that reflects as much at the normal as the specular factors
    // say.
    const float mean = static_cast<float>(factor * (tint[0] + tint[1] + tint[2]) / 3);
    const float root = std::min((eta_ - 1) / (eta_ + 1) * std::sqrt(mean), kLargestRoot);
    eta_ = (1 + root) / (1 - root);
}

}  // namespace covtrace::gltf
