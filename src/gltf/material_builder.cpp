#include "gltf/material_builder.h"

#include <algorithm>
#include <cmath>

#include "gltf/extensions.h"

namespace covtrace::gltf {
namespace {

using Channel = ImageTexture::Channel;

tinygltf::TextureInfo plain_info(const tinygltf::NormalTextureInfo& normal) {
    tinygltf::TextureInfo info;
    info.index = normal.index;
    info.texCoord = normal.texCoord;
    info.extensions = normal.extensions;
    return info;
}

}  // namespace

Surface MaterialBuilder::build() {
    warn_of_left_out(document_, material_.extensions, place_, log_);
    read_base();
    choose_uv_set();
    read_alpha();
    if (is_unlit_ || extension(material_.extensions, "KHR_materials_unlit")) {
        build_unlit();
        return surface_;
    }
    surface_.is_seen_from_back = material_.doubleSided ||
                                 extension(material_.extensions, "KHR_materials_transmission") ||
                                 extension(material_.extensions, kDiffuseTransmission);
    read_emission();
    read_normal_map();
    base_ = tinted(
        textures_.colour(use(base_colour_.texture), base_colour_.factor, base_colour_.place));
    if (specular_glossiness()) {
        read_specular_glossiness();
        read_anisotropy();
        surface_.material = add(dielectric(widths_));
        return surface_;
    }
    const auto mr = use(pbr_.metallicRoughnessTexture);
    widths_.u = widths_.v =
        squared(mr, Channel::green, within(pbr_.roughnessFactor, 0, 1, pbr("roughnessFactor")),
                pbr("metallicRoughnessTexture"));
    read_anisotropy();
    read_index();
    read_specular();
    read_iridescence();
    read_sheen();
    read_clearcoat();
    const float metallic = within(pbr_.metallicFactor, 0, 1, pbr("metallicFactor"));
    surface_.material = metals_and_others(mr, metallic);
    return surface_;
}

float MaterialBuilder::within(double value, double least, double most, const std::string& place) {
    return static_cast<float>(nearest(document_, value, least, most, place, log_));
}

float MaterialBuilder::share(const tinygltf::Value& object, const char* key, double otherwise,
                             const std::string& place) {
    return within(number(document_, object, key, otherwise, -kAny, kAny, place), 0, 1,
                  place + "." + key);
}

Rgb MaterialBuilder::colour(const std::vector<double>& v, size_t count, double most, Rgb otherwise,
                            const std::string& place) {
    if (v.empty()) return otherwise;
    if (v.size() != count)
        document_.refuse(place, "expected " + std::to_string(count) + " numbers");
    return {within(v[0], 0, most, place), within(v[1], 0, most, place),
            within(v[2], 0, most, place)};
}

void MaterialBuilder::read_base() {
    if (const tinygltf::Value* e = specular_glossiness()) {
        const std::string place = in(kSpecularGlossiness);
        auto v = numbers<4>(document_, *e, "diffuseFactor", {1, 1, 1, 1}, 0, place);
        for (double& one : v) one = within(one, 0, 1, place + ".diffuseFactor");
        base_colour_ = {{float(v[0]), float(v[1]), float(v[2])},
                        float(v[3]),
                        texture_info(document_, *e, "diffuseTexture", place),
                        place + ".diffuseTexture"};
        return;
    }
    const auto& factor = pbr_.baseColorFactor;
    const std::string place = pbr("baseColorFactor");
    base_colour_ = {colour(factor, 4, 1, Rgb(1), place), 1, pbr_.baseColorTexture,
                    pbr("baseColorTexture")};
    if (factor.size() == 4) base_colour_.alpha = within(factor[3], 0, 1, place);
}

MaterialId MaterialBuilder::add(decltype(MaterialDescription::value) model) {
    MaterialDescription m;
    m.name = material_.name;
    m.value = std::move(model);
    m.where = document_.place(place_);
    m.normal_map = normal_map_;
    m.normal_scale = normal_scale_;
    m.maps_follow_uv = true;
    m.tangent_rotation = tangent_rotation_;
    m.tangent_direction = tangent_direction_;
    m.sheen = sheen_;
    m.clearcoat = clearcoat_;
    scene_.materials.push_back(std::move(m));
    return static_cast<MaterialId>(scene_.materials.size() - 1);
}

MaterialId MaterialBuilder::mix(MaterialId a, MaterialId b, TextureId amount) {
    const MaterialId id = add(DiffuseMaterial{});
    scene_.materials.back().mix = MaterialMix{{a, b}, amount};
    return id;
}

MaterialBuilder::ExtensionTextures MaterialBuilder::extension_textures() const {
    const auto texture = [this](const char* name, const char* key) {
        const tinygltf::Value* e = extension(material_.extensions, name);
        return e ? texture_info(document_, *e, key, in(name)) : tinygltf::TextureInfo{};
    };
    return {texture("KHR_materials_clearcoat", kClearcoatNormal),
            texture("KHR_materials_anisotropy", "anisotropyTexture"),
            texture("KHR_materials_transmission", "transmissionTexture")};
}

void MaterialBuilder::choose_uv_set() {
    const ExtensionTextures more = extension_textures();
    VertexLayout& layout = surface_.layout;
    layout.has_colours = colours_.tints || colours_.has_holes;
    layout.needs_tangents = material_.normalTexture.index >= 0 ||
                            more.clearcoat_normal.index >= 0 ||
                            extension(material_.extensions, "KHR_materials_anisotropy");
    // The colours' slopes are told by the surface's (u, v). The file's own may be the same at all
    // corners, as those of models that are painted from a palette; a triangle's are not.
    if (layout.has_colours && !layout.needs_tangents) return;
    layout.uv_set = 0;
    for (const tinygltf::TextureInfo& info :
         {plain_info(material_.normalTexture), more.clearcoat_normal, more.anisotropy,
          base_colour_.texture, pbr_.metallicRoughnessTexture, material_.emissiveTexture,
          more.transmission}) {
        if (info.index < 0) continue;
        layout.uv_set = TextureReader::uv_set(document_, info, place_);
        break;
    }
}

TextureUse MaterialBuilder::use(const tinygltf::TextureInfo& info) {
    TextureUse use{info, -1};
    if (info.index < 0) return use;
    VertexLayout& layout = surface_.layout;
    const int set = TextureReader::uv_set(document_, info, place_);
    if (set == layout.uv_set) {
        layout.needs_uvs = true;
        return use;
    }
    const auto known = std::find(layout.more_sets.begin(), layout.more_sets.end(), set);
    use.mapped_set = static_cast<int>(known - layout.more_sets.begin());
    if (known == layout.more_sets.end()) layout.more_sets.push_back(set);
    return use;
}

TextureId MaterialBuilder::tinted(TextureId colour) {
    if (!colours_.tints) return colour;
    return textures_.product(colour, textures_.vertex_colour(false), true);
}

TextureId MaterialBuilder::squared(const TextureUse& info, Channel channel, float factor,
                                   const std::string& place) {
    if (info.index < 0) return textures_.constant(factor * factor);
    const TextureId r = textures_.channel(info, channel, factor, place);
    return textures_.product(r, r, false);
}

void MaterialBuilder::read_alpha() {
    const std::string& mode = material_.alphaMode;
    if (mode == "OPAQUE" || mode.empty()) return;
    const float factor = base_colour_.alpha;
    if (mode == "MASK") {
        read_mask(factor, within(material_.alphaCutoff, 0, 1e30, place_ + ".alphaCutoff"));
    } else if (mode == "BLEND") {
        const TextureUse info = use(base_colour_.texture);
        surface_.is_visible = factor > 0;
        if (info.index >= 0)
            surface_.alpha = textures_.channel(info, Channel::alpha, factor, base_colour_.place);
        else if (factor < 1)
            surface_.alpha = textures_.constant(factor);
        if (colours_.has_holes)
            surface_.alpha =
                surface_.alpha < 0
                    ? textures_.vertex_colour(true)
                    : textures_.product(surface_.alpha, textures_.vertex_colour(true), false);
    } else {
        document_.refuse(place_ + ".alphaMode", "expected OPAQUE, MASK or BLEND");
    }
}

void MaterialBuilder::read_mask(float factor, float cutoff) {
    if (factor < cutoff) {
        surface_.is_visible = false;  // alpha is at most the factor
        return;
    }
    if (!(cutoff > 0)) return;
    const TextureUse info = use(base_colour_.texture);
    const std::string& place = base_colour_.place;
    if (!colours_.has_holes) {
        if (info.index >= 0) surface_.alpha = textures_.mask(info, cutoff / factor, place);
        return;
    }
    surface_.alpha =
        textures_.cutoff(textures_.product(textures_.channel(info, Channel::alpha, factor, place),
                                           textures_.vertex_colour(true), false),
                         cutoff);
}

void MaterialBuilder::emit(Rgb radiance, TextureId image) {
    AreaLightDescription light;
    light.radiance = radiance;
    light.two_sided = material_.doubleSided;
    light.where = document_.place(place_);
    light.image = image;
    surface_.emission = light;
}

void MaterialBuilder::build_unlit() {
    surface_.material =
        add(UnlitMaterial{tinted(textures_.colour(use(base_colour_.texture), base_colour_.factor,
                                                  base_colour_.place)),
                          material_.doubleSided});
}

void MaterialBuilder::read_emission() {
    // Writers of before KHR_materials_emissive_strength gave strong lights factors above 1.
    const Rgb factor =
        colour(material_.emissiveFactor, 3, kAny, Rgb(0), place_ + ".emissiveFactor");
    double strength = 1;
    if (const auto* e = extension(material_.extensions, "KHR_materials_emissive_strength"))
        strength = number(document_, *e, "emissiveStrength", 1, 0, 1e30,
                          in("KHR_materials_emissive_strength"));
    const Rgb radiance = factor * static_cast<float>(strength);
    if (is_black(radiance)) return;
    const TextureUse info = use(material_.emissiveTexture);
    emit(radiance,
         info.index < 0 ? -1 : textures_.colour(info, Rgb(1), place_ + ".emissiveTexture"));
    surface_.is_strong_light = max_component(radiance) > 1;
}

void MaterialBuilder::read_normal_map() {
    normal_map_ =
        textures_.linear(use(plain_info(material_.normalTexture)), place_ + ".normalTexture");
    normal_scale_ =
        within(material_.normalTexture.scale, -1e6, 1e6, place_ + ".normalTexture.scale");
}

}  // namespace covtrace::gltf
