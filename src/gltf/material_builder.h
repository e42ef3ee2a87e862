/// Private to this folder: one material on its way into the scene.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>

#include "gltf/document.h"
#include "gltf/materials.h"
#include "gltf/textures.h"
#include "scene/scene_description.h"

namespace covtrace::gltf {

inline Rgb rgb(const std::array<double, 3>& v) {
    return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

class MaterialBuilder {
  public:
    MaterialBuilder(const Document& document, SceneDescription& scene, WarningLog& log,
                    TextureReader& textures, const tinygltf::Material& material, ColourUse colours,
                    bool is_unlit, std::string place)
        : document_(document),
          scene_(scene),
          log_(log),
          textures_(textures),
          material_(material),
          pbr_(material.pbrMetallicRoughness),
          colours_(colours),
          is_unlit_(is_unlit),
          place_(std::move(place)) {}

    /// Appends the material's models and textures to the scene; docs/guide/gltf.md has all
    /// substitutions.
    Surface build();

  private:
    void warn(const std::string& text) { log_.add(document_.place(place_), text); }
    std::string pbr(const char* key) const { return place_ + ".pbrMetallicRoughness." + key; }
    std::string in(const char* extension) const { return place_ + ".extensions." + extension; }

    /// The number, or the nearer end of [least, most] with a warning.
    float within(double value, double least, double most, const std::string& place);
    /// A number from 0 to 1 of an extension's object; others as `within`.
    float share(const tinygltf::Value& object, const char* key, double otherwise,
                const std::string& place);
    /// A colour of `count` numbers, each in [0, most] as `within`; `otherwise` where there is none.
    Rgb colour(const std::vector<double>& v, size_t count, double most, Rgb otherwise,
               const std::string& place);

    MaterialId add(decltype(MaterialDescription::value) model);
    MaterialId mix(MaterialId a, MaterialId b, TextureId amount);

    /// Chooses the set of coordinates that becomes the surface's (u, v): that of the normal map,
    /// whose tangents these give; else of the base colour, else of the first texture.
    void choose_uv_set();
    /// The texture reference with the place of its coordinates, which meshes will have.
    TextureUse use(const tinygltf::TextureInfo& info);
    /// The texture times the colours of the vertices, where these matter.
    TextureId tinted(TextureId colour);

    /// Texture of (factor times channel)^2: glTF's roughness squared is the width alpha of GGX.
    TextureId squared(const TextureUse& info, ImageTexture::Channel channel, float factor,
                      const std::string& place);
    void read_alpha();
    void read_mask(float factor, float cutoff);
    /// Lets the surface shine with the texture's colour, which may be none, times `radiance`.
    void emit(Rgb radiance, TextureId image);
    void build_unlit();
    /// The texture references of the material's extensions that may be the ones to give the
    /// surface its tangents: of the clear coat's normals, the anisotropy and the transmission.
    struct ExtensionTextures {
        tinygltf::TextureInfo clearcoat_normal, anisotropy, transmission;
    };
    ExtensionTextures extension_textures() const;
    void read_emission();
    void read_normal_map();

    /// The colour of a material with its alpha: of its metallic-roughness values, or of
    /// KHR_materials_pbrSpecularGlossiness in place of them.
    struct BaseColour {
        Rgb factor{1};
        float alpha = 1;
        tinygltf::TextureInfo texture;
        std::string place;  ///< of the texture
    };
    void read_base();
    /// The extension's values; null where the material has none.
    const tinygltf::Value* specular_glossiness() const;

    /// The border of what is no metal: its index and, where something else than the index says what
    /// it reflects, the textures of CoatedDiffuseMaterial.
    struct Border {
        float eta = 1.5f;
        TextureId normal_reflectance = -1, weight = -1;
        bool dims_base = false;
        float mean_eta = 1.5f;  ///< index that reflects the mean of all that at the normal
    };
    void read_index();
    void read_specular();
    void read_specular_glossiness();

    /// Widths of GGX along the tangent and across it.
    struct Widths {
        TextureId u = -1, v = -1;
    };
    void read_anisotropy();

    CoatedDiffuseMaterial dielectric(Widths widths) const;
    ConductorMaterial metal() const;

    void read_iridescence();
    void read_sheen();
    void read_clearcoat();
    /// The part that is neither metal nor clear; with KHR_materials_diffuse_transmission a mixture
    /// with a surface that lets light through diffusely, whose share has no highlights.
    MaterialId opaque_dielectric();
    bool has_thickness(const tinygltf::Value& volume) const;

    /// Makes the glass of KHR_materials_transmission: a body with a volume refracts, a surface
    /// without is a pane.
    MaterialId glass();
    /// Sets the absorption inside by Beer's law: transmittance `attenuationColor` after
    /// `attenuationDistance`.
    void read_absorption(const tinygltf::Value& volume);
    MaterialId dielectric_surface();
    MaterialId metals_and_others(const TextureUse& texture, float metallic);

    /// Stands for no limit.
    static constexpr double kAny = 1e30;
    static constexpr const char* kClearcoatNormal = "clearcoatNormalTexture";
    static constexpr const char* kDiffuseTransmission = "KHR_materials_diffuse_transmission";
    static constexpr const char* kSpecularGlossiness = "KHR_materials_pbrSpecularGlossiness";
    /// Largest roughness of panes that are rendered clear: their blur is below 1/400 radian.
    static constexpr double kClearRoughness = 0.05;

    const Document& document_;
    SceneDescription& scene_;
    WarningLog& log_;
    TextureReader& textures_;
    const tinygltf::Material& material_;
    const tinygltf::PbrMetallicRoughness& pbr_;
    const ColourUse colours_;
    const bool is_unlit_;
    const std::string place_;
    Surface surface_;
    BaseColour base_colour_;
    TextureId base_ = -1;
    Widths widths_;
    TextureId normal_map_ = -1, tangent_direction_ = -1;
    float normal_scale_ = 1, tangent_rotation_ = 0;
    Border border_;
    std::optional<ThinFilmDescription> film_;
    std::optional<SheenLayer> sheen_;
    std::optional<ClearcoatLayer> clearcoat_;
};

}  // namespace covtrace::gltf
