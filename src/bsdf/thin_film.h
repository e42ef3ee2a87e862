/// A film over a surface that is about as thick as light's wavelength, such as oil, soap or the
/// oxide of tempered steel: the light of its two borders interferes, and takes on colours that
/// change with the angle.
#pragma once

#include "core/vec.h"

namespace covtrace {

struct ThinFilm {
    float weight = 0;       ///< share of the surface that the film covers, in [0, 1]
    float eta = 1.3f;       ///< index of the film over that of the outside, > 0
    float thickness = 400;  ///< nanometres, >= 0
};

/// Thickness, nm, below which a film is none, more and more: its index goes over to that of the
/// outside, over as many nanometres as in KHR_materials_iridescence.
inline constexpr float kThinnestFilm = 0.03f;

/// Reflectance of a covered surface in linear Rec.709 for unpolarised light with the cosine
/// `cos_i`, in [0, 1], to its normal. `base`: what the surface reflects at the normal without the
/// film; channel by channel it is taken for that of a real index. The formula is Airy's sum,
/// integrated over the spectrum once for all as Belcour and Barla have it (2017, "A Practical
/// Extension to Microfacet Theory for the Modeling of Varying Iridescence"): with colour matching
/// functions that are sums of Gaussians over the wavenumber. Of the light that goes to and fro in
/// the film the first two rounds interfere. Light of even power is white.
Rgb film_reflectance(const ThinFilm& film, float cos_i, Rgb base);

/// The reflectance of a surface that the film covers in part, `bare` that of the rest.
inline Rgb under_film(const ThinFilm& film, float cos_i, Rgb base, Rgb bare) {
    return film.weight > 0 ? lerp(film.weight, bare, film_reflectance(film, cos_i, base)) : bare;
}

/// The share of light that a clear surface reflects, which lets the rest through.
struct ReflectedShare {
    Rgb share;
    float chance = 0;  ///< probability that a sample is reflected
};

/// That of the border of a clear body. `cos_outside`: cosine of the light on the film's side, of
/// which the share is the same in both directions; `normal`, `bare`: reflectance without the film
/// at the normal and for this light, which is 1 where reflection is total.
inline ReflectedShare reflected_share(const ThinFilm& film, float cos_outside, float normal,
                                      float bare) {
    if (!(film.weight > 0) || bare >= 1) return {Rgb(bare), bare};
    const Rgb share = under_film(film, cos_outside, Rgb(normal), Rgb(bare));
    return {share, (share.r + share.g + share.b) / 3};
}

}  // namespace covtrace
