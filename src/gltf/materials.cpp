#include "gltf/materials.h"

#include <cmath>

namespace covtrace::gltf {
namespace {

using Channel = ImageTexture::Channel;
using Model = decltype(MaterialDescription::value);

/// Numbers that the library leaves unchecked.
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

bool is_known(const std::string& extension) {
    for (const char* name : {"KHR_materials_emissive_strength", "KHR_materials_transmission",
                             "KHR_materials_ior", "KHR_materials_clearcoat", "KHR_materials_unlit",
                             "KHR_materials_volume", "KHR_materials_specular"})
        if (extension == name) return true;
    return false;
}

/// One material on its way into the scene.
class Builder {
  public:
    Builder(const Document& document, SceneDescription& scene, WarningLog& log,
            TextureReader& textures, const tinygltf::Material& material, std::string place)
        : document_(document),
          scene_(scene),
          log_(log),
          textures_(textures),
          material_(material),
          pbr_(material.pbrMetallicRoughness),
          place_(std::move(place)) {}

    Surface build() {
        for (const auto& [name, unused] : material_.extensions)
            if (!is_known(name)) warn("extension " + name + " is not supported and left out");
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
        const float metallic =
            in_range(document_, pbr_.metallicFactor, 0, 1, pbr("metallicFactor"));
        surface_.material = with_clearcoat(metals_and_others(mr, metallic));
        return surface_;
    }

  private:
    void warn(const std::string& text) { log_.add(document_.place(place_), text); }
    std::string pbr(const char* key) const { return place_ + ".pbrMetallicRoughness." + key; }
    std::string in(const char* extension) const { return place_ + ".extensions." + extension; }

    MaterialId add(Model model) {
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
    MaterialId mix(MaterialId a, MaterialId b, TextureId amount) {
        const MaterialId id = add(DiffuseMaterial{});
        scene_.materials.back().mix = MaterialMix{{a, b}, amount};
        return id;
    }

    /// One mesh has one set of coordinates: that of the base colour, else of the first texture.
    void choose_uv_set() {
        const tinygltf::Value* transmission =
            extension(material_.extensions, "KHR_materials_transmission");
        const tinygltf::TextureInfo none;
        const tinygltf::TextureInfo transmitted =
            transmission ? texture_info(document_, *transmission, "transmissionTexture",
                                        in("KHR_materials_transmission"))
                         : none;
        for (const tinygltf::TextureInfo& info :
             {pbr_.baseColorTexture, pbr_.metallicRoughnessTexture,
              plain_info(material_.normalTexture), material_.emissiveTexture, transmitted}) {
            if (info.index < 0) continue;
            const int set = TextureReader::uv_set(document_, info, place_);
            if (surface_.uv_set < 0) surface_.uv_set = set;
        }
    }
    /// The reference, or none where it needs coordinates that the mesh won't have.
    tinygltf::TextureInfo use(const tinygltf::TextureInfo& info) {
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

    /// (factor times channel)^2: glTF's roughness squared is the width alpha of GGX.
    TextureId squared(const tinygltf::TextureInfo& info, Channel channel, float factor,
                      const std::string& place) {
        if (info.index < 0) return textures_.constant(factor * factor);
        const TextureId r = textures_.channel(info, channel, factor, place);
        return textures_.product(r, r, false);
    }

    void read_alpha() {
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

    void emit(Rgb radiance, const tinygltf::TextureInfo& info, const std::string& place) {
        AreaLightDescription light;
        light.radiance = radiance;
        light.two_sided = material_.doubleSided;
        light.where = document_.place(place_);
        if (info.index >= 0) light.image = textures_.colour(info, Rgb(1), place);
        surface_.emission = light;
    }

    void build_unlit() {
        warn(
            "KHR_materials_unlit: an emitter of the base colour takes its place, which also "
            "lights what is near");
        surface_.material = add(DiffuseMaterial{textures_.constant(Rgb(0), true)});
        if (!is_black(base_factor_))
            emit(base_factor_, use(pbr_.baseColorTexture), pbr("baseColorTexture"));
    }

    void read_emission() {
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

    void read_normal_map() {
        normal_map_ =
            textures_.linear(use(plain_info(material_.normalTexture)), place_ + ".normalTexture");
        normal_scale_ = in_range(document_, material_.normalTexture.scale, -1e6, 1e6,
                                 place_ + ".normalTexture.scale");
    }

    void read_index() {
        if (const auto* e = extension(material_.extensions, "KHR_materials_ior")) {
            const double ior = number(document_, *e, "ior", 1.5, 0, 100, in("KHR_materials_ior"));
            if (ior > 0 && ior < 1)
                document_.refuse(in("KHR_materials_ior"), "expected an ior of 0 or at least 1");
            // 0 stands for a border that reflects everything; 100 reflects 96 %.
            eta_ = static_cast<float>(ior > 0 ? ior : 100);
        }
        const auto* specular = extension(material_.extensions, "KHR_materials_specular");
        if (!specular) return;
        const std::string place = in("KHR_materials_specular");
        const double factor = number(document_, *specular, "specularFactor", 1, 0, 1, place);
        const auto tint =
            numbers<3>(document_, *specular, "specularColorFactor", {1, 1, 1}, 0, place);
        if (specular->Has("specularTexture") || specular->Has("specularColorTexture") ||
            tint[0] != tint[1] || tint[1] != tint[2])
            warn("KHR_materials_specular: textures and colours are left out, their mean is used");
        // The border that reflects as much at the normal.
        const float mean = static_cast<float>(factor * (tint[0] + tint[1] + tint[2]) / 3);
        const float at_normal = std::min(sqr((eta_ - 1) / (eta_ + 1)) * mean, 0.96f);
        const float root = std::sqrt(at_normal);
        eta_ = (1 + root) / (1 - root);
    }

    CoatedDiffuseMaterial dielectric(TextureId roughness) const {
        CoatedDiffuseMaterial m;
        m.reflectance = base_;
        m.u_roughness = m.v_roughness = roughness;
        m.remap_roughness = false;
        m.eta = eta_;
        m.reflects_through_coat = true;
        return m;
    }
    ConductorMaterial metal() const {
        ConductorMaterial m;
        m.reflectance = base_;
        m.u_roughness = m.v_roughness = alpha_;
        m.remap_roughness = false;
        return m;
    }

    /// A material in two versions: as it is, and under a clear coat.
    struct Coatable {
        MaterialId plain = -1, coated = -1;
    };
    struct Clearcoat {
        float factor = 0;
        TextureId amount = -1, alpha = -1;
    };

    void read_clearcoat() {
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

    Coatable coatable(MaterialId plain, Model coated) {
        return {plain, clearcoat_ ? add(std::move(coated)) : -1};
    }

    Coatable mixed(Coatable a, Coatable b, TextureId amount) {
        return {mix(a.plain, b.plain, amount), clearcoat_ ? mix(a.coated, b.coated, amount) : -1};
    }

    Coatable metal_surface() {
        CoatedConductorMaterial coated;
        coated.conductor = metal();
        coated.u_roughness = coated.v_roughness = clearcoat_ ? clearcoat_->alpha : -1;
        coated.thickness = clearcoat_ ? textures_.constant(0) : -1;
        coated.remap_roughness = false;
        return coatable(add(metal()), coated);
    }

    Coatable opaque_dielectric() {
        return coatable(add(dielectric(alpha_)),
                        dielectric(clearcoat_ ? clearcoat_->alpha : alpha_));
    }

    /// KHR_materials_transmission: a body with a volume refracts, a surface without is a pane.
    MaterialId glass() {
        const auto* volume = extension(material_.extensions, "KHR_materials_volume");
        const bool has_volume = volume && number(document_, *volume, "thicknessFactor", 0, 0, 1e30,
                                                 in("KHR_materials_volume")) > 0;
        const bool is_rough =
            pbr_.metallicRoughnessTexture.index >= 0 || pbr_.roughnessFactor > kClearRoughness;
        if (has_volume) read_absorption(*volume);
        if (!has_volume && !is_rough) return add(ThinDielectricMaterial{eta_, base_});
        if (!has_volume)
            warn(
                "KHR_materials_transmission: a rough surface without KHR_materials_volume is "
                "rendered as the rough border of a solid body, which refracts");
        DielectricMaterial m;
        m.eta = eta_;
        m.u_roughness = m.v_roughness = alpha_;
        m.remap_roughness = false;
        m.transmittance = base_;
        return add(m);
    }

    /// Beer's law: transmittance `attenuationColor` after `attenuationDistance`.
    void read_absorption(const tinygltf::Value& volume) {
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

    Coatable dielectric_surface() {
        const auto* e = extension(material_.extensions, "KHR_materials_transmission");
        const std::string place = in("KHR_materials_transmission");
        const double factor = e ? number(document_, *e, "transmissionFactor", 0, 0, 1, place) : 0.0;
        if (factor == 0) return opaque_dielectric();
        const auto info = use(texture_info(document_, *e, "transmissionTexture", place));
        const MaterialId clear = glass();
        const Coatable transmitting{clear, clear};  // its own border shines like the coat
        if (factor == 1 && info.index < 0) return transmitting;
        return mixed(opaque_dielectric(), transmitting,
                     textures_.channel(info, Channel::red, static_cast<float>(factor),
                                       place + ".transmissionTexture"));
    }

    Coatable metals_and_others(const tinygltf::TextureInfo& texture, float metallic) {
        read_clearcoat();
        if (metallic == 0) return dielectric_surface();
        if (metallic == 1 && texture.index < 0) return metal_surface();
        const Coatable other = dielectric_surface(), metal = metal_surface();
        return mixed(
            other, metal,
            textures_.channel(texture, Channel::blue, metallic, pbr("metallicRoughnessTexture")));
    }

    MaterialId with_clearcoat(Coatable surface) {
        if (!clearcoat_) return surface.plain;
        return mix(surface.plain, surface.coated, clearcoat_->amount);
    }

    /// Panes up to this roughness are rendered clear: their blur is below 1/400 radian.
    static constexpr double kClearRoughness = 0.05;

    const Document& document_;
    SceneDescription& scene_;
    WarningLog& log_;
    TextureReader& textures_;
    const tinygltf::Material& material_;
    const tinygltf::PbrMetallicRoughness& pbr_;
    const std::string place_;
    Surface surface_;
    Rgb base_factor_;
    TextureId base_ = -1, alpha_ = -1;
    TextureId normal_map_ = -1;
    float normal_scale_ = 1;
    float eta_ = 1.5f;
    std::optional<Clearcoat> clearcoat_;
};

}  // namespace

const Surface& MaterialReader::surface(int index, const std::string& place) {
    if (index >= 0) at(document_, document_.model.materials, index, "materials", place);
    const int key = std::max(index, -1);
    const auto it = surfaces_.find(key);
    if (it != surfaces_.end()) return it->second;
    const bool is_default = key < 0;
    const tinygltf::Material otherwise;
    const tinygltf::Material& material =
        is_default ? otherwise : document_.model.materials[static_cast<size_t>(key)];
    const std::string here = is_default ? place : element("materials", static_cast<size_t>(key));
    Surface surface = Builder(document_, scene_, log_, textures_, material, here).build();
    return surfaces_.emplace(key, std::move(surface)).first->second;
}

}  // namespace covtrace::gltf
