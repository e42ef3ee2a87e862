/// The models behind bsdf.h, one overload set each; bsdf.cpp chooses among them.
///
/// Functions behave as described in bsdf.h. All models but the dielectric look the same from both
/// sides. The interface and the unlit surface are specular and have only `sample` here; their other
/// overloads, constants all of them, are in bsdf.cpp.
#pragma once

#include <cmath>

#include "bsdf/bsdf.h"
#include "bsdf/fresnel.h"

namespace covtrace {

Rgb eval(const DiffuseBsdf& b, Vec3 wo, Vec3 wi);
float pdf(const DiffuseBsdf& b, Vec3 wo, Vec3 wi);
std::optional<BsdfSample> sample(const DiffuseBsdf& b, Vec3 wo, float u_lobe, Vec2 u);
LobeShares lobe_shares(const DiffuseBsdf& b, Vec3 wo, Vec3 wi, Rgb value);

Rgb eval(const ConductorBsdf& b, Vec3 wo, Vec3 wi);
float pdf(const ConductorBsdf& b, Vec3 wo, Vec3 wi);
BsdfValue eval_and_pdf(const ConductorBsdf& b, Vec3 wo, Vec3 wi);
std::optional<BsdfSample> sample(const ConductorBsdf& b, Vec3 wo, float u_lobe, Vec2 u);
LobeShares lobe_shares(const ConductorBsdf& b, Vec3 wo, Vec3 wi, Rgb value);
Rgb albedo(const ConductorBsdf& b, Vec3 wo);
/// Reflectance of a metal's facets without a film, for light with the cosine `cos_i` >= 0 to their
/// normal.
inline Rgb bare_reflectance(const ConductorBsdf& b, float cos_i) {
    return b.schlick ? schlick_reflectance(cos_i, *b.schlick)
                     : fresnel_conductor(cos_i, b.eta, b.k);
}
/// The same with what the metal has of a film.
inline Rgb reflectance(const ConductorBsdf& b, float cos_i) {
    const Rgb bare = bare_reflectance(b, cos_i);
    return b.film.weight > 0 ? under_film(b.film, cos_i, bare_reflectance(b, 1), bare) : bare;
}

/// Value of a dielectric. Refraction carries the factor 1 / eta^2 by which radiance changes (eta:
/// index on wi's side over that on wo's side), since paths start at the camera.
Rgb eval(const DielectricBsdf& b, Vec3 wo, Vec3 wi);
float pdf(const DielectricBsdf& b, Vec3 wo, Vec3 wi);
std::optional<BsdfSample> sample(const DielectricBsdf& b, Vec3 wo, float u_lobe, Vec2 u);
LobeShares lobe_shares(const DielectricBsdf& b, Vec3 wo, Vec3 wi, Rgb value);
/// True where the border is smooth, or there is none since the indices match.
bool is_specular(const DielectricBsdf& b);

Rgb eval(const CoatedDiffuseBsdf& b, Vec3 wo, Vec3 wi);
float pdf(const CoatedDiffuseBsdf& b, Vec3 wo, Vec3 wi);
BsdfValue eval_and_pdf(const CoatedDiffuseBsdf& b, Vec3 wo, Vec3 wi);
std::optional<BsdfSample> sample(const CoatedDiffuseBsdf& b, Vec3 wo, float u_lobe, Vec2 u);
LobeShares lobe_shares(const CoatedDiffuseBsdf& b, Vec3 wo, Vec3 wi, Rgb value);
Rgb albedo(const CoatedDiffuseBsdf& b, Vec3 wo);

/// Light that enters is left out of `eval`, as that of a specular lobe is: only a walk through the
/// body finds what comes out of it. A sample that enters is specular, whatever its direction.
Rgb eval(const SubsurfaceBsdf& b, Vec3 wo, Vec3 wi);
float pdf(const SubsurfaceBsdf& b, Vec3 wo, Vec3 wi);
std::optional<BsdfSample> sample(const SubsurfaceBsdf& b, Vec3 wo, float u_lobe, Vec2 u);
LobeShares lobe_shares(const SubsurfaceBsdf& b, Vec3 wo, Vec3 wi, Rgb value);
bool is_specular(const SubsurfaceBsdf& b);
Rgb albedo(const SubsurfaceBsdf& b, Vec3 wo);

Rgb eval(const DiffuseTransmissionBsdf& b, Vec3 wo, Vec3 wi);
float pdf(const DiffuseTransmissionBsdf& b, Vec3 wo, Vec3 wi);
std::optional<BsdfSample> sample(const DiffuseTransmissionBsdf& b, Vec3 wo, float u_lobe, Vec2 u);
LobeShares lobe_shares(const DiffuseTransmissionBsdf& b, Vec3 wo, Vec3 wi, Rgb value);

Rgb eval(const CoatedConductorBsdf& b, Vec3 wo, Vec3 wi);
float pdf(const CoatedConductorBsdf& b, Vec3 wo, Vec3 wi);
std::optional<BsdfSample> sample(const CoatedConductorBsdf& b, Vec3 wo, float u_lobe, Vec2 u);
LobeShares lobe_shares(const CoatedConductorBsdf& b, Vec3 wo, Vec3 wi, Rgb value);
bool is_specular(const CoatedConductorBsdf& b);
Rgb albedo(const CoatedConductorBsdf& b, Vec3 wo);

Rgb eval(const HazyDiffuseBsdf& b, Vec3 wo, Vec3 wi);
float pdf(const HazyDiffuseBsdf& b, Vec3 wo, Vec3 wi);
std::optional<BsdfSample> sample(const HazyDiffuseBsdf& b, Vec3 wo, float u_lobe, Vec2 u);
LobeShares lobe_shares(const HazyDiffuseBsdf& b, Vec3 wo, Vec3 wi, Rgb value);
Rgb albedo(const HazyDiffuseBsdf& b, Vec3 wo);

Rgb eval(const ThinDielectricBsdf& b, Vec3 wo, Vec3 wi);
float pdf(const ThinDielectricBsdf& b, Vec3 wo, Vec3 wi);
BsdfValue eval_and_pdf(const ThinDielectricBsdf& b, Vec3 wo, Vec3 wi);
std::optional<BsdfSample> sample(const ThinDielectricBsdf& b, Vec3 wo, float u_lobe, Vec2 u);
LobeShares lobe_shares(const ThinDielectricBsdf& b, Vec3 wo, Vec3 wi, Rgb value);
bool is_specular(const ThinDielectricBsdf& b);
Rgb albedo(const ThinDielectricBsdf& b, Vec3 wo);

std::optional<BsdfSample> sample(const InterfaceBsdf& b, Vec3 wo, float u_lobe, Vec2 u);
std::optional<BsdfSample> sample(const UnlitBsdf& b, Vec3 wo, float u_lobe, Vec2 u);

/// Value of a layered surface, which is not reciprocal: the clear coat dims what is below by what
/// it reflects for wo alone, as KHR_materials_clearcoat and Blender have it.
Rgb eval(const LayeredBsdf& b, Vec3 wo, Vec3 wi);
float pdf(const LayeredBsdf& b, Vec3 wo, Vec3 wi);
BsdfValue eval_and_pdf(const LayeredBsdf& b, Vec3 wo, Vec3 wi);
std::optional<BsdfSample> sample(const LayeredBsdf& b, Vec3 wo, float u_lobe, Vec2 u);
LobeShares lobe_shares(const LayeredBsdf& b, Vec3 wo, Vec3 wi, Rgb value);
bool is_specular(const LayeredBsdf& b);
Rgb albedo(const LayeredBsdf& b, Vec3 wo);

/// Share of the light of a surface that gets out through a sheen and a clear coat above it, in a
/// direction with the given cosine > 0 to their normal: what neither of them reflects of light that
/// comes from there, and what the coat does not absorb.
Rgb layer_transmission(const SheenLobe& sheen, const ClearcoatLobe& coat, float cosine);

/// The surface below the layers.
Bsdf base_of(const LayeredBsdf& layered);

Rgb eval(const MeasuredBsdf& b, Vec3 wo, Vec3 wi);
float pdf(const MeasuredBsdf& b, Vec3 wo, Vec3 wi);
std::optional<BsdfSample> sample(const MeasuredBsdf& b, Vec3 wo, float u_lobe, Vec2 u);
LobeShares lobe_shares(const MeasuredBsdf& b, Vec3 wo, Vec3 wi, Rgb value);
Rgb albedo(const MeasuredBsdf& b, Vec3 wo);

Rgb eval(const HairBsdf& b, Vec3 wo, Vec3 wi);
float pdf(const HairBsdf& b, Vec3 wo, Vec3 wi);
BsdfValue eval_and_pdf(const HairBsdf& b, Vec3 wo, Vec3 wi);
std::optional<BsdfSample> sample(const HairBsdf& b, Vec3 wo, float u_lobe, Vec2 u);
LobeShares lobe_shares(const HairBsdf& b, Vec3 wo, Vec3 wi, Rgb value);
Rgb albedo(const HairBsdf& b, Vec3 wo);

inline bool same_side(Vec3 wo, Vec3 wi) {
    return wo.z * wi.z > 0;
}
inline Vec3 mirror_z(Vec3 w) {
    return {w.x, w.y, -w.z};
}
inline Vec3 to_upper_side(Vec3 w) {
    return {w.x, w.y, std::abs(w.z)};
}
/// A cosine-distributed direction on the side of wo, with `transmit` on the other side.
Vec3 sample_cosine(Vec3 wo, bool transmit, Vec2 u);

}  // namespace covtrace
