/// Models of surfaces for tests that hold for all of them, with their tables.
#pragma once

#include "bsdf/coat_table.h"
#include "bsdf/gap_spectrum.h"
#include "bsdf/hair.h"
#include "bsdf/models.h"
#include "bsdf/multiple_scattering.h"
#include "bsdf/sheen.h"

namespace covtrace {

inline const CoatTable& coat() {
    static const CoatTable table(1.5f, 0.01f);
    return table;
}

inline const CoatTable& white() {
    static const CoatTable table(kWhiteIndex, 0);
    return table;
}

inline CoatTint tint() {
    return {{0.6f, 0.2f, 0}, 0.9f, &white()};
}

inline ConductorBsdf bouncing_copper(float alpha_x, float alpha_y) {
    return with_multiple_scattering(
        {Rgb(0.2f, 0.92f, 1.1f), Rgb(3.9f, 2.45f, 2.14f), alpha_x, alpha_y}, white());
}

/// A metal that is known by its colours.
inline ConductorBsdf schlick_metal(float alpha_x, float alpha_y) {
    ConductorBsdf b{Rgb(1), Rgb(0), alpha_x, alpha_y};
    b.schlick = metal_of_edge({0.9f, 0.5f, 0}, {0.6f, 1, 0});
    return b;
}

inline ConductorBsdf filmed_metal(float alpha_x, float alpha_y) {
    ConductorBsdf b = schlick_metal(alpha_x, alpha_y);
    b.film = {0.7f, 1.4f, 350};
    return b;
}
inline CoatTint filmed() {
    CoatTint t = tint();
    t.film = {1, 1.8f, 400};
    return t;
}

inline DielectricBsdf bouncing_glass(float alpha) {
    static const CoatTable outside(1.5f, 0), inside(1 / 1.5f, 0);
    return with_multiple_scattering({1.5f, alpha, alpha, Rgb(0.95f)}, outside, inside);
}

inline DielectricBsdf bouncing_filmed_glass(float alpha) {
    static const CoatTable outside(1.5f, 0), inside(1 / 1.5f, 0);
    static const FilmTable table(FilmKernel(1.5f), 2.5f, 150);
    DielectricBsdf b{1.5f, alpha, alpha, Rgb(0.95f)};
    b.film = {0.9f, 2.5f, 150};
    return with_multiple_scattering(b, outside, inside, &table);
}

inline CoatedDiffuseBsdf bouncing_satin(float alpha_x, float alpha_y) {
    static const CoatTable table(1.5f, white());
    return make_coated_total(table, {0.7f, 0.5f, 0}, alpha_x, alpha_y, {}, &white());
}

inline CoatedConductorBsdf coated_metal(float coat_x, float coat_y, float metal_x, float metal_y) {
    CoatedConductorBsdf b;
    b.coat = {1.5f, coat_x, coat_y};
    b.metal = {Rgb(0.13f, 0.6f, 0.73f), Rgb(2.6f, 1.63f, 1.43f), metal_x, metal_y};
    b.thickness = 0.01f;
    return b;
}

/// A coated metal whose gap scatters, more of it forwards.
inline CoatedConductorBsdf hazy_metal(float coat, float metal) {
    CoatedConductorBsdf b = coated_metal(coat, coat, metal, metal);
    b.thickness = 0.6f;
    b.gap = {{0.9f, 0.6f, 0}, 0.4f, 10};
    return b;
}

inline HazyDiffuseBsdf hazy_diffuse(float coat) {
    return {{1.5f, coat, coat}, {{0.7f, 0.5f, 0}}, 0.6f, 1, 0, {{0.9f, 0.6f, 0}, 0.4f, 10}};
}

/// The same with the spectra of its colours.
inline HazyDiffuseBsdf banded_haze(float coat) {
    HazyDiffuseBsdf b = hazy_diffuse(coat);
    static const GapSpectrum spectrum{ColourBands(), band_values(b.gap.albedo),
                                      band_values(b.base.reflectance), true};
    b.gap.spectrum = &spectrum;
    return b;
}

inline ThinDielectricBsdf filmed_pane(float alpha) {
    ThinDielectricBsdf b{1.5f, Rgb(0.9f), alpha, alpha};
    b.film = {0.9f, 2, 300};
    return b;
}

inline SubsurfaceBsdf wax(float alpha_x, float alpha_y, bool is_left, bool refracts = true) {
    SubsurfaceBsdf b;
    b.border = make_coated_total(coat(), {0.7f, 0.5f, 0}, alpha_x, alpha_y);
    b.facet_alpha_x = alpha_x;
    b.facet_alpha_y = alpha_y;
    b.refracted_share = refracts ? 1 : 0.5f;
    b.refracts = refracts;
    b.is_left = is_left;
    return b;
}

inline SheenLobe sheen(float alpha) {
    static const SheenTable table;
    return {{0.9f, 0.5f, 0.1f}, alpha, &table};
}

/// A clear coat whose normal is that of the surface, or another one.
inline ClearcoatLobe clear(float alpha, Vec3 normal = {0, 0, 1}) {
    return {0.8f, alpha, normalize(normal)};
}

/// A tinted clear coat with a border of its own.
inline ClearcoatLobe lacquer(float alpha, Vec3 normal = {0, 0, 1}) {
    static const CoatTable border(1.5f, 0);
    return {0.8f, alpha, normalize(normal), &border, {0.9f, 0.4f, 0}};
}

/// Hair that is hit at the given place across it.
inline HairBsdf hair(float beta_m, float beta_n, float offset, Rgb absorption = {0.1f, 0.3f, 1}) {
    HairBsdf b = make_hair({.beta_m = beta_m, .beta_n = beta_n}, absorption);
    b.offset = offset;
    return b;
}

}  // namespace covtrace
