/// Scattering at a surface point: a closed set of models behind sample / eval / pdf.
///
/// Directions are unit vectors in the local shading frame (z = shading normal) and point away from
/// the surface. `eval` includes the factor |cos(wi)|; densities are per solid angle of wi. All
/// places that a new model touches: docs/internals/architecture.md, "To add".
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <variant>

#include "bsdf/schlick_metal.h"
#include "bsdf/thin_film.h"
#include "core/vec.h"

namespace covtrace {

enum class LobeKind : uint8_t {
    diffuse_reflection,
    diffuse_transmission,
    sheen_reflection,  ///< as wide as a diffuse one, brightest at grazing angles
    glossy_reflection,
    glossy_transmission,
    hair_reflection,  ///< of a strand, to the side of the frame that the light comes from
    hair_transmission,
    specular_reflection,
    specular_transmission
};
constexpr bool is_specular(LobeKind k) {
    return k == LobeKind::specular_reflection || k == LobeKind::specular_transmission;
}
constexpr bool is_diffuse(LobeKind k) {
    return k == LobeKind::diffuse_reflection || k == LobeKind::diffuse_transmission ||
           k == LobeKind::sheen_reflection;
}
constexpr bool is_transmission(LobeKind k) {
    return k == LobeKind::diffuse_transmission || k == LobeKind::glossy_transmission ||
           k == LobeKind::hair_transmission || k == LobeKind::specular_transmission;
}

struct BsdfSample {
    Vec3 wi;
    Rgb weight;     ///< f |cos(wi)| / pdf; for specular lobes the factor on the throughput
    float pdf = 0;  ///< of the whole model, per solid angle; for specular lobes the probability of
                    ///< the choice
    LobeKind lobe{};
    float eta = 1;  ///< index on wi's side over the index on wo's side
};

/// One lobe's part in a pair of directions, for the frequency analysis: how much of the light takes
/// it, and what its shape depends on (`lobe_function` of lobe_function.h is that shape).
struct LobeShare {
    LobeKind kind{};
    Rgb value;  ///< this lobe's part of eval(wo, wi); for a sampled specular lobe its weight
    /// GGX, along the local x and y, or a sheen's, both the same; 0 for diffuse and specular. Of
    /// hair the standard deviations, radians, of the angle to the cross section of the strand,
    /// which lies along x, and of the angle about it; infinite where all of these are alike.
    float alpha_x = 0, alpha_y = 0;
    float eta = 1;  ///< index on wi's side over the index on wo's side
    /// Border that reflects a glossy lobe, or that covers a diffuse one: its index over that of
    /// wo's side, `border_k` the imaginary part of a conductor's. 0: no Fresnel factor.
    float border_eta = 0, border_k = 0;
    /// Normal that a round lobe (alpha_x = alpha_y) faces, unit, local; that of a clear coat may
    /// not be the frame's.
    Vec3 normal{0, 0, 1};
    /// Border of a metal that has no index; none: `border_eta` tells.
    std::optional<SchlickMetal<float>> border_metal = {};
    /// Whether both faces of a pane reflect together, and what passes them leaves by the same lobe
    /// as what they reflect, mirrored to the other side.
    bool is_pane = false;
    /// Whether a Fresnel factor belongs to the lobe.
    bool has_border() const { return border_eta > 0 || border_metal; }
};
struct LobeShares {
    static constexpr size_t kMost = 4;
    std::array<LobeShare, kMost> lobes;
    int count = 0;
};

struct DiffuseBsdf {
    Rgb reflectance;
};
class CoatTable;  // shares of light that a rough border reflects and transmits
class FilmTable;  // share of light that rough glass under a film keeps
struct ConductorBsdf {
    Rgb eta, k;                      ///< relative to the outside
    float alpha_x = 0, alpha_y = 0;  ///< 0, 0: a perfect mirror
    /// Table of a border that reflects everything, where light that meets several microfacets comes
    /// back; none: it is lost. See multiple_scattering.h.
    const CoatTable* white = nullptr;
    float table_row = 0;  ///< of `white`, for the mean roughness
    Rgb regained = {};    ///< share of the light lost by a first reflection that comes back later
    /// Reflectance in place of that of `eta` and `k`, which count only where there is none.
    std::optional<SchlickMetal<Rgb>> schlick = {};
    ThinFilm film = {};  ///< over it
};
struct Dispersion;  // scene/dispersion.h
struct DielectricBsdf {
    float eta = 1.5f;  ///< inside (-z) over outside (+z)
    float alpha_x = 0, alpha_y = 0;
    Rgb transmittance{1};  ///< of light that crosses the border
    /// How `eta` depends on the wavelength, for paths to look up; none: not at all.
    const Dispersion* dispersion = nullptr;
    /// Tables of the border as it is met from outside and from inside, where light that meets
    /// several microfacets comes back; none: it is lost. See multiple_scattering.h.
    const CoatTable *from_outside = nullptr, *from_inside = nullptr;
    float table_row = 0;  ///< of all, for the mean roughness
    ThinFilm film = {};   ///< over it, outside
    /// Table of the border where the film covers it; with both others, or not at all.
    const FilmTable* under_film = nullptr;
};
/// A coat's reflectance in place of its index' Fresnel reflectance F: w (r + (1 - r) x), with r the
/// reflectance at the normal, w the weight, and x = (F - F0) / (1 - F0), which grows from 0 at the
/// normal to 1 at grazing angles. It is exact in x, so that Schlick's (1 - cos)^5, which glTF's
/// extensions have there, differs by the shape of Fresnel's curve alone.
struct CoatTint {
    Rgb normal_reflectance;  ///< r, in [0, 1]
    float weight = 1;        ///< w, in [0, 1]
    /// Table of a border that reflects everything; none: F itself is reflected.
    const CoatTable* white = nullptr;
    ThinFilm film = {};  ///< over the coat; what it reflects has the weight w, too
};
/// Lambertian base below a dielectric coat; two-sided. Made by make_coated_diffuse (coat_table.h).
struct CoatedDiffuseBsdf {
    Rgb reflectance;  ///< of the base alone
    Rgb base;         ///< of the base's lobe, without both transmissions through the coat
    float eta = 1.5f;
    float alpha_x = 0, alpha_y = 0;
    const CoatTable* table = nullptr;
    float table_row = 0;          ///< row of `table` for the mean roughness
    float mean_transmission = 0;  ///< of the coat, at the mean roughness
    /// Whether all light that the coat doesn't reflect enters; see make_coated_total.
    bool is_total = false;
    CoatTint tint;  ///< where it is total
    /// ConductorBsdf::white of a rough border, where it is total and has no tint; see
    /// make_coated_total.
    const CoatTable* white = nullptr;
};
/// A body that scatters light below its border: where light arrives at it, and where light that was
/// scattered inside leaves it. What goes on between is a walk of the path; see subsurface.cpp.
struct SubsurfaceBsdf {
    /// Border, total, over a base that has the reflectance of the body.
    CoatedDiffuseBsdf border;
    Rgb absorption, scattering;  ///< coefficients inside, per scene unit
    float g = 0;                 ///< mean cosine of the phase function
    /// Whether the border reflects inside, and refracts light that leaves; else that leaves evenly
    /// in all directions.
    bool refracts = true;
    /// Share of the light that enters which is refracted, by facets of these widths and of this
    /// index; the rest goes on inside evenly in all directions.
    float refracted_share = 1;
    float facet_eta = 1.5f, facet_alpha_x = 0, facet_alpha_y = 0;
    bool is_left = false;  ///< whether the light comes from below, where wo then is
};
struct DiffuseTransmissionBsdf {
    Rgb reflectance, transmittance;
};
struct GapSpectrum;
/// A medium that scatters in the gap below a coat. See coated_walk.h.
struct GapScattering {
    Rgb albedo{};     ///< share of the light that it keeps
    float g = 0;      ///< mean cosine of the phase function, in (-1, 1)
    int events = 10;  ///< most reflections and scatterings of a walk
    /// Spectra to take in place of the albedo's channels; none: the channels.
    const GapSpectrum* spectrum = nullptr;
    bool scatters() const { return max_component(albedo) > 0; }
};
/// A metal below a dielectric coat; two-sided. See coated_conductor.cpp.
struct CoatedConductorBsdf {
    DielectricBsdf coat;
    ConductorBsdf metal;  ///< indices relative to the coat's
    float thickness = 0;  ///< of the gap between them, in optical depths
    int bounces = 5;      ///< most reflections at the metal
    int samples = 1;      ///< walks per evaluation
    /// Part of the seed of `eval`'s walks: equal pairs have equal walks where this is the same.
    uint32_t place = 0;
    GapScattering gap = {};
};
/// A Lambertian base below a dielectric coat, where the gap between them scatters; two-sided. See
/// hazy_diffuse.cpp.
struct HazyDiffuseBsdf {
    DielectricBsdf coat;
    DiffuseBsdf base;
    float thickness = 0;  ///< of the gap, in optical depths
    int samples = 1;      ///< walks per evaluation
    uint32_t place = 0;   ///< as CoatedConductorBsdf's
    GapScattering gap;
};
/// A pane without thickness; both faces' reflections together. See thin_dielectric.cpp.
struct ThinDielectricBsdf {
    float eta = 1.5f;
    Rgb transmittance{1};            ///< multiplies what passes both faces
    float alpha_x = 0, alpha_y = 0;  ///< 0, 0: clear
    /// ConductorBsdf::white of a rough pane.
    const CoatTable* white = nullptr;
    float table_row = 0;  ///< of `white`, for the mean roughness
    ThinFilm film = {};   ///< over one of the faces
};
/// The border between media, which lets everything pass.
struct InterfaceBsdf {};
/// A surface without lighting, which scatters nothing: as an interface, but for rays that see it.
struct UnlitBsdf {
    Rgb colour;  ///< radiance
    bool two_sided = false;
};
class SheenTable;
/// Fibres over a surface: see sheen.h.
struct SheenLobe {
    Rgb colour;       ///< 0: there is no sheen
    float alpha = 1;  ///< in [SheenTable::kLeastAlpha, 1]
    const SheenTable* table = nullptr;
};
/// A clear coat over a surface; see layered.cpp.
struct ClearcoatLobe {
    float weight = 0;      ///< in [0, 1]; 0: there is no coat
    float alpha = 0;       ///< GGX; 0: smooth
    Vec3 normal{0, 0, 1};  ///< unit, local, on the outside
    /// Table, without a gap, of the coat's border, whose index tells its reflectance; none: that of
    /// KHR_materials_clearcoat.
    const CoatTable* border = nullptr;
    Rgb tint{1};  ///< share of light that crosses a full coat along its normal, down and back
};
/// A surface under a sheen, under a clear coat.
struct LayeredBsdf {
    std::variant<DiffuseBsdf, ConductorBsdf, DielectricBsdf, CoatedDiffuseBsdf, HazyDiffuseBsdf,
                 ThinDielectricBsdf>
        base;
    SheenLobe sheen;
    ClearcoatLobe coat;
};

class MeasuredBrdf;  // measured_brdf.h
/// A surface as it was measured; two-sided.
struct MeasuredBsdf {
    const MeasuredBrdf* brdf = nullptr;
};

/// A strand of hair along the local x, whichever surface stands for it; made by make_hair (hair.h).
/// The arrays are of light that is reflected (R), that passes the strand (TT), that is reflected
/// inside once (TRT), and of all other light together.
struct HairBsdf {
    static constexpr size_t kWays = 4;
    Rgb absorption;     ///< in the strand, per its radius
    float eta = 1.55f;  ///< >= 1
    float offset = 0;   ///< h: place across the strand as seen along wo, in [-1, 1], towards wo x X
    std::array<float, kWays> variance{};              ///< v, of the angle to the cross section
    std::array<float, kWays> faintest{};              ///< exp(-2 / v)
    std::array<float, kWays> sin_tilt{}, cos_tilt{};  ///< of the angle that scales turn light by
    float scale = 0;  ///< s, of the logistic distribution of the angle about the strand
    float tail = 0;   ///< share of that distribution beyond pi, on one side
};

using Bsdf =
    std::variant<DiffuseBsdf, ConductorBsdf, DielectricBsdf, CoatedDiffuseBsdf,
                 DiffuseTransmissionBsdf, CoatedConductorBsdf, HazyDiffuseBsdf, ThinDielectricBsdf,
                 InterfaceBsdf, MeasuredBsdf, UnlitBsdf, LayeredBsdf, HairBsdf, SubsurfaceBsdf>;

/// The value f(wo, wi) |cos(wi)|, without specular lobes.
Rgb eval(const Bsdf& bsdf, Vec3 wo, Vec3 wi);
/// Density with which `sample` returns wi for this wo, without specular lobes. Coated metals, whose
/// density has no closed form, give a function near it: good for weights between strategies, but no
/// factor of any estimate. Their `weight` is a random walk's, whose expectation is f |cos(wi)| /
/// pdf.
float pdf(const Bsdf& bsdf, Vec3 wo, Vec3 wi);
/// Value and density together, as light sampling needs them, for less than the two apart.
struct BsdfValue {
    Rgb f;
    float pdf = 0;
};
BsdfValue eval_and_pdf(const Bsdf& bsdf, Vec3 wo, Vec3 wi);
/// Samples a direction. Empty where sampling failed: the path ends with no contribution. `u_lobe`
/// chooses the lobe.
std::optional<BsdfSample> sample(const Bsdf& bsdf, Vec3 wo, float u_lobe, Vec2 u);
/// True for models whose lobes are all specular: eval is zero for every pair.
bool is_specular(const Bsdf& bsdf);
/// True for models with a lobe that spreads light over a whole hemisphere.
bool has_diffuse_lobe(const Bsdf& bsdf);
/// True for models with a lobe that reflects or refracts light about one direction.
bool has_sharp_lobe(const Bsdf& bsdf);
/// The larger GGX alpha of a model's sharp lobe, of both where there are two; 0 where it is
/// specular, infinite where there is none.
float sharp_lobe_roughness(const Bsdf& bsdf);
/// Whether a sample goes into a body that scatters light inside, where only a walk goes on.
bool enters_body(const Bsdf& bsdf, const BsdfSample& s);
/// The parts of `value` = eval(wo, wi), lobe by lobe; their values sum to it. Specular lobes have
/// no part. Callers have evaluated the pair before, so that nothing is computed twice.
LobeShares lobe_shares(const Bsdf& bsdf, Vec3 wo, Vec3 wi, Rgb value);
/// Directional albedo for this wo, approximate where no closed form exists; for the albedo layer.
Rgb albedo(const Bsdf& bsdf, Vec3 wo);

}  // namespace covtrace
