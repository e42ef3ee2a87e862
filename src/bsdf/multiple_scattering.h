/// Light that meets several microfacets of a rough border, and is lost by single scattering: it
/// comes back where each lobe's value is multiplied by a gain that hangs on wo alone.
///
/// E(wo): share of the light along wo that single scattering keeps where nothing is absorbed, of a
/// metal what it reflects, of glass what it reflects and transmits together; CoatTable has it, by
/// quadrature, of a border of infinite index for metals and of the glass as met from either side;
/// that of glass under a film, by colour, is in FilmTable. Glass gets the gain 1 / E (Turquin 2019,
/// "Practical multiple scattering compensation for microfacet models"), so that all light leaves; a
/// metal
///
///    1 + R (1 - E) / E,   R = F mean(E) / (1 - F (1 - mean(E)))
///
/// with the cosine-weighted means of Fresnel's reflectance, F, and of E: what a first reflection
/// does not let out is reflected at the mean reflectance until it leaves (Kulla and Conty 2017,
/// "Revisiting physically based shading at Imageworks", without the factor F of the first
/// reflection, which the lobe has). R is 1 where nothing is absorbed.
///
/// The gain makes the model one that is not reciprocal: f(wo, wi) / f(wi, wo) is the ratio of both
/// gains. An added lobe of (1 - E(wo)) (1 - E(wi)) would be, but is as wide as a diffuse one and
/// needs sampling of its own; Cycles has gains. Sampling and density stay those of the single
/// lobe, and so does its spectrum: as a function of wi the lobe keeps its shape, and over wo the
/// gain varies within a radian or so, far slower than any lobe that it multiplies.
///
/// Anisotropic borders have the E of the isotropic one of their mean square roughness: a white
/// metal of alphas 0.1 and 0.5 gives back 0.87 to 1.05 of the light, by direction, one of 0.01 and 1
/// 0.55 to 1.10 (docs/decisions/0135). Alphas above 1 have the gain of 1, which is too low.
#pragma once

#include "bsdf/coat_table.h"
#include "bsdf/film_table.h"

namespace covtrace {

/// The metal with its later reflections. `white`: table of kWhiteIndex without a gap.
ConductorBsdf with_multiple_scattering(ConductorBsdf metal, const CoatTable& white);
/// The glass with its later reflections. Tables without a gap: `from_outside` of the index inside
/// over outside, `from_inside` of its inverse. Where the index varies with the wavelength, they are
/// those of its middle. `under_film`: the table of its film, where it has one.
DielectricBsdf with_multiple_scattering(DielectricBsdf glass, const CoatTable& from_outside,
                                        const CoatTable& from_inside,
                                        const FilmTable* under_film = nullptr);

/// The rough pane with its later reflections and transmissions, by the gain 1 / E of glass.
ThinDielectricBsdf with_multiple_scattering(ThinDielectricBsdf pane, const CoatTable& white);

/// Factor on the value of a metal's pairs for wo with the cosine `cos_o` > 0; 1 without later
/// reflections.
inline Rgb gain(const ConductorBsdf& b, float cos_o) {
    if (!b.white) return Rgb(1);
    const float kept = b.white->shares(b.table_row, cos_o).reflection;
    return Rgb(1) + b.regained * ((1 - kept) / kept);
}
/// The same of a rough pane, from either side.
inline float gain(const ThinDielectricBsdf& b, float cos_o) {
    return b.white ? 1 / b.white->shares(b.table_row, cos_o).reflection : 1;
}
/// The same of rough glass, from either side.
inline Rgb gain(const DielectricBsdf& b, Vec3 wo) {
    const CoatTable* table = wo.z > 0 ? b.from_outside : b.from_inside;
    if (!table) return Rgb(1);
    const float cos_o = std::abs(wo.z);
    const CoatTable::Shares s = table->shares(b.table_row, cos_o);
    const float bare = s.reflection + s.transmission;
    if (!b.under_film || !(b.film.weight > 0)) return Rgb(1 / bare);
    return Rgb(1) / lerp(b.film.weight, Rgb(bare),
                         b.under_film->kept(wo.z < 0, b.table_row, cos_o, b.film.thickness));
}

}  // namespace covtrace
