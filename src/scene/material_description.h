/// The materials of a scene, as its files describe them. Roughness textures hold pbrt's
/// "roughness"; `remap_roughness` says that alpha = sqrt(roughness).
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "core/error.h"
#include "scene/texture_description.h"

namespace covtrace {

using MaterialId = int;  ///< index into SceneDescription::materials

/// A film over a border that is so thin that light interferes in it.
struct ThinFilmDescription {
    float eta = 1.3f;          ///< index relative to the outside
    TextureId weight = -1;     ///< share of the surface that is covered; none: 1
    TextureId thickness = -1;  ///< nanometres; none: 400
};
struct DiffuseMaterial {
    TextureId reflectance = -1;
};
struct ConductorMaterial {
    TextureId eta = -1, k = -1;  ///< relative to vacuum; both or neither
    TextureId reflectance = -1;  ///< in place of eta and k
    /// How `reflectance`, which is that at the normal, goes on towards grazing angles: as that of
    /// the metal of index 1 that has it, by Schlick's formula with a dip, or the same at all
    /// angles.
    enum class Edge { of_index, schlick, none };
    Edge edge = Edge::of_index;
    /// Reflectance at 82 degrees over that without a dip, of Edge::schlick; none: 1.
    TextureId edge_tint = -1;
    TextureId u_roughness = -1, v_roughness = -1;
    bool remap_roughness = true;
    /// Whether light that meets several microfacets comes back, too; else it is lost, as in pbrt.
    bool multiple_scattering = false;
    std::optional<ThinFilmDescription> film = {};
};
struct Dispersion;  // dispersion.h
struct DielectricMaterial {
    float eta = 1.5f;  ///< at 587.6 nm, where it varies with the wavelength
    std::shared_ptr<const Dispersion> dispersion = {};  ///< none: all wavelengths have `eta`
    TextureId u_roughness = -1, v_roughness = -1;
    bool remap_roughness = true;
    bool multiple_scattering = false;  ///< as that of a metal
    TextureId transmittance = -1;      ///< multiplies light at each crossing of the border; none: 1
    std::optional<ThinFilmDescription> film = {};  ///< on the border's outside
};
/// A diffuse base under a dielectric coat, a thin gap between them.
struct CoatedDiffuseMaterial {
    TextureId reflectance = -1;
    TextureId u_roughness = -1, v_roughness = -1;  ///< of the coat
    TextureId thickness = -1;                      ///< of the gap, in optical depths
    TextureId g = -1, albedo = -1;                 ///< of the medium in the gap
    float eta = 1.5f;                              ///< of the coat
    bool remap_roughness = true;
    int max_depth = 10, samples = 1;
    /// Whether a medium in the gap scatters, so that light takes a walk.
    bool scatters_in_gap() const { return !reflects_through_coat && albedo >= 0; }
    /// Whether `reflectance` is the share that leaves of all light that the coat doesn't reflect:
    /// diffuse under specular, as in glTF. Then `thickness`, `g`, `albedo`, `max_depth` and
    /// `samples` don't count.
    bool reflects_through_coat = false;
    /// As that of a metal, of the coat; with `reflects_through_coat` only, and with none of
    /// `normal_reflectance`, `coat_weight` and `film`.
    bool multiple_scattering = false;
    /// Reflectance of the coat at the normal, in place of that of `eta`, which then only says how
    /// it grows to 1 at grazing angles; with `reflects_through_coat` only.
    TextureId normal_reflectance = -1;
    /// Factor on all that the coat reflects, in [0, 1]; none: 1. With `reflects_through_coat` only.
    TextureId coat_weight = -1;
    /// Whether the base keeps of `reflectance` what is left of 1 beside the largest channel of
    /// `normal_reflectance`, as in glTF's specular-glossiness.
    bool coat_dims_base = false;
    std::optional<ThinFilmDescription> film = {};  ///< with `reflects_through_coat` only
};
/// A body that scatters light below its border. Where `border.reflectance` is given, it is the
/// share that leaves again of the light that enters a wide and deep one, and `mean_free_path` is
/// that of the light inside; else the coefficients count.
struct SubsurfaceMaterial {
    CoatedDiffuseMaterial border;                ///< its `reflects_through_coat` is set
    TextureId mean_free_path = -1;               ///< scene units; none: 1
    TextureId absorption = -1, scattering = -1;  ///< per scene unit, times `scale`
    TextureId g = -1;                            ///< mean cosine of the phase function; none: 0
    float scale = 1;
    /// Whether the border refracts, and reflects inside; else light crosses it evenly in all
    /// directions, as in Cycles' random walk.
    bool refracts = true;
    /// Without that, share of the light that enters which is refracted all the same, by facets of
    /// the width alpha and of the index given here.
    float refracted_share = 0, facet_eta = 1.4f, facet_alpha = 1;
};
struct DiffuseTransmissionMaterial {
    TextureId reflectance = -1, transmittance = -1;
    float scale = 1;
};
/// A metal under a dielectric coat, a thin gap between them.
struct CoatedConductorMaterial {
    ConductorMaterial conductor;  ///< indices relative to vacuum, as if there were no coat
    TextureId u_roughness = -1, v_roughness = -1;  ///< of the coat
    TextureId thickness = -1;                      ///< of the gap, in optical depths
    TextureId g = -1, albedo = -1;                 ///< of the medium in the gap
    float eta = 1.5f;                              ///< of the coat
    bool remap_roughness = true;
    int max_depth = 10, samples = 1;
};
/// A pane whose two faces are so close that light leaves it where it entered.
struct ThinDielectricMaterial {
    float eta = 1.5f;
    TextureId transmittance = -1;  ///< of the pane; none: 1
    /// GGX widths of both faces together, which spread what passes as what they reflect; none: 0.
    TextureId u_roughness = -1, v_roughness = -1;
    static constexpr bool remap_roughness = false;
    std::optional<ThinFilmDescription> film = {};  ///< over one of its faces
};
/// No surface at all: a border that only separates media.
struct InterfaceMaterial {};
struct BrdfTensor;  // brdf_tensor.h
/// A surface whose reflection was measured.
struct MeasuredMaterial {
    std::shared_ptr<const BrdfTensor> brdf;
};
/// A strand of hair along dp/du (bsdf/hair.h). Of the three descriptions of its pigment the first
/// that is given counts: absorption, reflectance, concentrations.
struct HairMaterial {
    TextureId absorption = -1;                   ///< per radius of the strand
    TextureId reflectance = -1;                  ///< of dense hair
    TextureId eumelanin = -1, pheomelanin = -1;  ///< concentrations; none: 0, of both: 1.3 and 0
    TextureId beta_m = -1, beta_n = -1;          ///< roughness along and about it; none: 0.3
    TextureId alpha = -1;                        ///< tilt of the scales, degrees; none: 2
    TextureId eta = -1;                          ///< none: 1.55
    TextureId coat = -1;  ///< share by which light that does not enter spreads less; none: 0
};
/// A surface without lighting: where the camera sees it, straight or by perfect mirrors and clear
/// glass, it has its colour whatever the light; all other light passes it as if it were not there.
struct UnlitMaterial {
    TextureId colour = -1;   ///< radiance; none: 1
    bool two_sided = false;  ///< whether it is there for rays that meet its back, too
};
/// A layer of GGX over a surface, both sides of which have it: glTF's KHR_materials_clearcoat, or
/// the coat of Blender's Principled.
struct ClearcoatLayer {
    TextureId weight = -1;  ///< share of the surface that has the layer; none: 1
    TextureId alpha = -1;   ///< width of GGX; none: 0
    /// Image of the layer's own tangent space normals, as MaterialDescription::normal_map; without
    /// it the layer has the surface's unmapped normal.
    TextureId normal_map = -1;
    float normal_scale = 1;  ///< of the map's x and y
    /// Index of a coat whose reflectance follows it; 0: that of the extension.
    float eta = 0;
    TextureId tint = -1;  ///< of light that crosses a full coat along the normal twice; none: 1
};
/// A layer of upright fibres over a surface, both sides of which have it: KHR_materials_sheen.
struct SheenLayer {
    TextureId colour = -1;  ///< none: 1
    TextureId alpha = -1;   ///< width of the fibres' distribution, in [0, 1]; none: 0
};
/// At each point one of two materials, the second one with probability `amount`.
struct MaterialMix {
    std::array<MaterialId, 2> materials{-1, -1};
    TextureId amount = -1;
    float weight = 1;  ///< of all light that either part scatters or lets pass: sums have above 1
};
struct MaterialDescription {
    std::string name;
    std::variant<DiffuseMaterial, ConductorMaterial, DielectricMaterial, CoatedDiffuseMaterial,
                 DiffuseTransmissionMaterial, CoatedConductorMaterial, ThinDielectricMaterial,
                 InterfaceMaterial, MeasuredMaterial, UnlitMaterial, HairMaterial,
                 SubsurfaceMaterial>
        value;
    SourceLocation where;
    std::optional<MaterialMix> mix = {};  ///< in place of `value`
    /// Float texture of the height that bump mapping adds along the normal, scene units.
    TextureId displacement = -1;
    /// Image of tangent space normals, (n + 1) / 2; it counts where there is a displacement, too.
    TextureId normal_map = -1;
    float normal_scale = 1;  ///< of the map's x and y
    /// Whether maps lie as (u, v) does. Else the normal map's y stands left of x also where (u, v)
    /// is mirrored, and on meshes with normals heights are taken for those of a v that stands left
    /// of u and is as long, as in pbrt.
    bool maps_follow_uv = false;
    /// Share of the normal that heights give, in a sum with the unturned one's rest; >= 0.
    float bump_strength = 1;
    /// Angle from x = dp/du to the axis that u_roughness lies along, radians, towards a map's y.
    float tangent_rotation = 0;
    /// Image of that axis before the rotation: (x, y) = 2 (r, g) - 1, as those of a normal map.
    TextureId tangent_direction = -1;
    /// Layers over `value`, the sheen below the clear coat; not over what lets all light pass.
    std::optional<SheenLayer> sheen = {};
    std::optional<ClearcoatLayer> clearcoat = {};
};

}  // namespace covtrace
