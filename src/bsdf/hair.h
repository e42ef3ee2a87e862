/// Hair: the model of Chiang et al. 2016, "A Practical and Controllable Hair and Fur Model for
/// Production Path Tracing", with the parameters of Pharr, Jakob and Humphreys 2023, "Physically
/// Based Rendering", section 9.9.
///
/// A strand is a rough cylinder of glass with scales and a pigment in it. Light that leaves it
/// after p ways through the inside is A_p M_p N_p: the share that takes this way, a distribution of
/// the angle theta to the cross section, one of the angle phi about the strand.
#pragma once

#include "bsdf/bsdf.h"

namespace covtrace {

/// The shape of a strand, as scene files describe it.
struct HairShape {
    float beta_m = 0.3f;  ///< roughness along the strand, in [0, 1]
    float beta_n = 0.3f;  ///< roughness about the strand, in [0, 1]
    float alpha = 2;      ///< of the scales, which lean towards the root (-x), degrees
    float eta = 1.55f;
    /// Share by which the roughness along the strand is less for light that does not enter it.
    float coat = 0;
};
/// Roughnesses below 0.001 count as that, indices below 1 as 1. `absorption`: of the pigment, per
/// radius of the strand, >= 0.
HairBsdf make_hair(const HairShape& shape, Rgb absorption);

/// Absorption that gives dense hair about this colour, by the fit of Chiang et al. 2016, eq. 9.
/// `reflectance` in [0, 1]; channels below 1e-5 count as that.
Rgb absorption_of_reflectance(Rgb reflectance, float beta_n);
/// Absorption of pigments of the given concentrations, >= 0, per radius; d'Eon et al. 2011, "An
/// Energy-Conserving Hair Reflectance Model".
Rgb absorption_of_pigments(float eumelanin, float pheomelanin);

}  // namespace covtrace
