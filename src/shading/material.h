/// The materials of a scene: texture values at a hit become a BSDF, with pbrt-v4's meaning of every
/// parameter.
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "bsdf/bsdf.h"
#include "bsdf/coat_table.h"
#include "bsdf/film_table.h"
#include "bsdf/gap_spectrum.h"
#include "bsdf/measured_brdf.h"
#include "bsdf/sheen.h"
#include "colour/illuminant_adaptation.h"
#include "colour/reflectance_powers.h"
#include "core/frame.h"
#include "geometry/hit.h"
#include "scene/scene_description.h"
#include "texture/texture.h"

namespace covtrace {

/// The local frame of a hit's BSDF, right-handed: z = ns, x = the hit's tangent made orthogonal to
/// it. alpha_x lies along x.
Frame shading_frame(const SurfaceHit& hit);

/// GGX widths for a pair of pbrt's roughnesses: alpha = sqrt(roughness) where they are remapped;
/// (0, 0), a smooth surface, where both are below 1e-3; at least 1e-4 each otherwise.
Vec2 ggx_alphas(float u_roughness, float v_roughness, bool remap);

/// A reflectance or transmittance of a material, for the light of the scene.
struct MaterialColour {
    TextureId texture = -1;  ///< texture, where the colour varies
    float scale = 1;         ///< of the texture
    Rgb fixed;               ///< the colour, where it does not vary
};
struct MaterialColours {
    MaterialColour reflectance, transmittance;
    ReflectancePowers fixed_powers{};  ///< of a reflectance below a coat that does not vary
};

/// The tables of a material; none where it needs none.
struct MaterialTables {
    const CoatTable* coat = nullptr;   ///< of a diffuse material's coat
    const CoatTable* white = nullptr;  ///< CoatTint::white, ConductorBsdf::white
    const CoatTable *from_outside = nullptr, *from_inside = nullptr;  ///< DielectricBsdf's
    const FilmTable* under_film = nullptr;                            ///< DielectricBsdf's
    const MeasuredBrdf* measured = nullptr;
    const SheenTable* sheen = nullptr;
    const CoatTable* clearcoat = nullptr;  ///< ClearcoatLobe::border
    const GapSpectrum* gap = nullptr;      ///< GapScattering::spectrum
};

/// The textures that modulate the light that a material's lobes reflect and transmit; -1 where
/// nothing varies.
struct MaterialTextures {
    TextureId reflectance = -1, transmittance = -1;
};

/// Widths of the sharp lobes of a BSDF: those of its material, or those that pbrt's "regularize"
/// makes of them.
enum class Lobes { as_given, regularized };

/// The material that stands at a place, and the factor on all light that it scatters or lets pass
/// there, but for what it emits.
struct PlacedMaterial {
    MaterialId id = -1;
    float weight = 1;
};

/// All materials of a scene. Immutable and thread-safe after construction.
class MaterialStore {
  public:
    /// Prepares the materials. `textures` must be made from the same scene. `adaptation` to the
    /// scene's light is applied to all reflectances and transmittances, not to refractive indices.
    MaterialStore(const SceneDescription& scene, const TextureStore& textures,
                  const IlluminantAdaptation& adaptation = {});
    MaterialStore(const MaterialStore&) = delete;
    MaterialStore& operator=(const MaterialStore&) = delete;

    /// The material that stands at a place: for a mix, one of its two, chosen by a hash of the
    /// position, so that the same place always has the same one. The other functions take the
    /// result.
    PlacedMaterial at(MaterialId id, const SurfaceHit& hit, const TextureStore& textures) const;
    /// The BSDF at a hit, for directions in `shading_frame(hit)`. Material -1 is pbrt's default:
    /// diffuse, 0.5. Images are filtered over the footprint of a pixel that sees the place along
    /// `w` and is `width` wide there; 0: they are not filtered.
    Bsdf bsdf(MaterialId id, const SurfaceHit& hit, const TextureStore& textures, Vec3 w = {},
              float width = 0, Lobes lobes = Lobes::as_given) const;
    MaterialTextures textures(MaterialId id) const;
    /// Whether all light passes the surface unchanged: interfaces and what is unlit.
    bool lets_light_pass(MaterialId id) const;
    /// Whether the surface, or that of a part of a mix, is under a sheen or a clear coat.
    bool has_layers(MaterialId id) const {
        return id >= 0 && materials_[static_cast<size_t>(id)].has_layers;
    }
    /// Share of the light of an emitting surface that gets through its layers, in a direction with
    /// the given cosine > 0 to the normal; of a mix, the mean over its parts.
    Rgb emission_share(MaterialId id, const TexturePoint& at, float cosine,
                       const TextureStore& textures) const;
    /// Whether the clear coat's normal may be another than that of the frame.
    bool turns_clearcoat(MaterialId id) const;
    /// Whether a bump or normal map turns the normals, or the material the tangents; see
    /// normal_map.h.
    bool turns_frame(MaterialId id) const;
    const MaterialDescription& description(MaterialId id) const {
        return materials_[static_cast<size_t>(id)].description;
    }
    /// Warnings of materials that are not rendered as the scene asks.
    const Warnings& warnings() const { return warnings_; }

  private:
    struct Material {
        MaterialDescription description;
        MaterialColours colours;
        MaterialTables tables;
        bool is_constant = false;
        bool has_layers = false;  ///< of its own, or of a part of a mix
        /// Where no texture varies; the latter in scenes that regularize.
        Bsdf constant, constant_regularized;
    };
    /// Makes the tables of a material's model, and warns of what is not rendered as it says.
    void prepare(const CoatedDiffuseMaterial& m, Material& material, const TextureStore& textures);
    void prepare(const SubsurfaceMaterial& m, Material& material, const TextureStore& textures);
    void prepare(const CoatedConductorMaterial& m, Material& material,
                 const TextureStore& textures);
    void prepare(const ConductorMaterial& m, Material& material, const TextureStore&);
    void prepare(const DielectricMaterial& m, Material& material, const TextureStore& textures);
    void prepare(const ThinDielectricMaterial& m, Material& material, const TextureStore&);
    void prepare(const MeasuredMaterial& m, Material& material, const TextureStore&);
    template <typename Other>
    void prepare(const Other&, Material&, const TextureStore&) {}
    /// The spectra of a gap whose albedo does not vary, and of the reflectance below it, none where
    /// that varies; null where channels tell as much: of greys.
    const GapSpectrum* gap_spectrum(TextureId albedo, const TextureStore& textures,
                                    const MaterialColour* base, const IlluminantAdaptation& light);

    std::vector<Material> materials_;
    AdaptationTable adaptation_;     ///< for textures that vary
    ReflectancePowersTable powers_;  ///< for textures that vary below a coat
    CoatTables coats_;
    FilmTables films_;
    std::map<const BrdfTensor*, MeasuredBrdf> measured_;  ///< by their tensors, which are shared
    std::unique_ptr<const SheenTable> sheen_;
    std::vector<std::unique_ptr<const GapSpectrum>> gaps_;
    Warnings warnings_;
};

}  // namespace covtrace
