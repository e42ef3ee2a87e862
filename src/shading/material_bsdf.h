/// A material's model and the values of its textures at one place become a BSDF.
#pragma once

#include "shading/material.h"
#include "shading/material_inputs.h"

namespace covtrace {

constexpr float kDefaultThickness = 0.01f;  ///< of a coat's gap, where the scene gives none

/// The index to use: where the file's spectrum doesn't reach the given one is 0, for which pbrt
/// takes 1.
inline float refractive_index(float eta) {
    return eta > 0 ? eta : 1;
}

/// Thickness of a film at one place, nm, >= 0.
inline float film_thickness(const ThinFilmDescription& film, const TextureStore& textures,
                            const TexturePoint& at) {
    if (film.thickness < 0) return ThinFilm{}.thickness;
    const float thickness = textures.eval_float(film.thickness, at);
    return std::isfinite(thickness) ? std::max(0.0f, thickness) : 0.0f;
}

/// Values of a material's textures at one place; `fallback` where the file gives none.
struct MaterialValues {
    const TextureStore& textures;
    TexturePoint at;
    const MaterialColours& colours;
    const AdaptationTable& adaptation;
    const ReflectancePowersTable& powers;
    Lobes lobes = Lobes::as_given;
    Rgb reflectance() const { return colour(colours.reflectance); }
    ReflectancePowers powers_of_reflectance() const {
        const MaterialColour& c = colours.reflectance;
        return c.texture < 0 ? colours.fixed_powers
                             : powers(c.scale * textures.eval(c.texture, at));
    }
    Rgb transmittance() const { return colour(colours.transmittance); }
    /// A reflectance or transmittance in [0, 1]; NaN becomes 0, so that a broken texel can't
    /// spread.
    Rgb colour(const MaterialColour& c) const {
        return c.texture < 0 ? c.fixed : adaptation(c.scale * textures.eval(c.texture, at));
    }
    Rgb spectrum(TextureId id, float fallback) const {
        return id < 0 ? Rgb(fallback) : textures.eval(id, at);
    }
    float number(TextureId id, float fallback) const {
        return id < 0 ? fallback : textures.eval_float(id, at);
    }
    CoatTint tint(const CoatedDiffuseMaterial& m, const CoatTable* white) const {
        return {share(spectrum(m.normal_reflectance, sqr((m.eta - 1) / (m.eta + 1)))),
                share(number(m.coat_weight, 1)), white, film(m.film)};
    }
    ThinFilm film(const std::optional<ThinFilmDescription>& f) const {
        if (!f) return {};
        return {share(number(f->weight, 1)), refractive_index(f->eta),
                film_thickness(*f, textures, at)};
    }
    /// GGX widths of a model that has a roughness.
    template <typename M>
    Vec2 alphas(const M& m) const {
        const Vec2 a =
            ggx_alphas(number(m.u_roughness, 0), number(m.v_roughness, 0), m.remap_roughness);
        return lobes == Lobes::regularized ? Vec2{regularized(a.x), regularized(a.y)} : a;
    }
    /// A GGX width as pbrt-v4 regularizes it: twice as wide, within limits; wide ones stay.
    static float regularized(float alpha) {
        constexpr float kNarrowest = 0.1f, kWidest = 0.3f;
        return alpha < kWidest ? std::clamp(2 * alpha, kNarrowest, kWidest) : alpha;
    }
};

/// The BSDF of a material's model, under its layers.
Bsdf make_bsdf(const MaterialDescription& material, const MaterialValues& values,
               const MaterialTables& tables);

}  // namespace covtrace
