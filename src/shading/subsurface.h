/// Bodies that scatter light inside: the coefficients of a medium that looks as a body is to look.
#pragma once

#include "bsdf/bsdf.h"

namespace covtrace {

/// Coefficients of a medium per scene unit.
struct Scattering {
    Rgb absorption, scattering;
};

/// The share of diffuse light inside a body that its border reflects back in, in [0, 1): 1 - T /
/// eta^2, with T the mean share that it lets in from outside (the solid angle of a bundle is eta^2
/// times larger outside).
float inner_reflectance(const CoatedDiffuseBsdf& border);

/// How light enters a body: evenly in all directions, or straight down, as pbrt-v4 takes it to.
enum class Entry { diffuse, perpendicular };

/// The medium of a half space of which the share `reflectance` leaves again of the light that
/// enters. `mean_free_path`: 1 / extinction, >= 0; `g`: mean cosine of its phase function;
/// `inside`: inner_reflectance of its border, 0 for none.
///
/// Of a medium without a border, of albedo a, the share is D = (1 - s)(1 - 0.139 s) / (1 + 1.17 s)
/// of diffuse light and P = (1 - s) / (1 + 2 s) of light straight down, s = sqrt((1 - a) / (1 - a
/// g)): fits of van de Hulst 1980, "Multiple Light Scattering", vol. 2 (with the constants as in
/// Kulla and Conty, SIGGRAPH course 2017) and Hapke 1981, "Bidirectional reflectance spectroscopy"
/// (1 - s H(1), H(x) = (1 + 2 x) / (1 + 2 x s)). Of what comes to the border from inside the share
/// r = `inside` is scattered again: (1 - r) P / (1 - r D), or with D in place of P, leaves.
Scattering scattering_of_reflectance(Rgb reflectance, Rgb mean_free_path, float g, float inside,
                                     Entry entry);
/// The inverse: the share of the light that leaves again.
Rgb reflectance_of_scattering(const Scattering& s, float g, float inside, Entry entry);

}  // namespace covtrace
