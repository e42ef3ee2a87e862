#include "shading/material_bsdf.h"

#include "bsdf/hair.h"
#include "bsdf/multiple_scattering.h"
#include "shading/material_layers.h"
#include "shading/subsurface.h"

namespace covtrace {

namespace {

using Values = MaterialValues;
using Tables = MaterialTables;

Rgb sqrt(Rgb c) {
    return {std::sqrt(c.r), std::sqrt(c.g), std::sqrt(c.b)};
}

Bsdf make(const DiffuseMaterial&, const Values& v, const Tables&) {
    return DiffuseBsdf{v.reflectance()};
}

/// A metal whose light is reflected once, without a film.
ConductorBsdf bare_metal(const ConductorMaterial& m, const Values& v) {
    const Vec2 alpha = v.alphas(m);
    if (m.reflectance < 0)
        return ConductorBsdf{v.spectrum(m.eta, 1), v.spectrum(m.k, 1), alpha.x, alpha.y};
    Rgb r = v.reflectance();
    if (m.edge != ConductorMaterial::Edge::of_index) {
        ConductorBsdf b{Rgb(1), Rgb(0), alpha.x, alpha.y};
        b.schlick = m.edge == ConductorMaterial::Edge::schlick
                        ? metal_of_edge(r, share(v.spectrum(m.edge_tint, 1)))
                        : SchlickMetal<Rgb>{r, r, Rgb(0)};
        return b;
    }
    // The metal has eta = 1 and the k that reflects r at normal incidence.
    constexpr float kMost = 0.9999f;
    r = {std::min(r.r, kMost), std::min(r.g, kMost), std::min(r.b, kMost)};
    return ConductorBsdf{Rgb(1), 2 * sqrt(r) / sqrt(Rgb(1) - r), alpha.x, alpha.y};
}

/// A metal whose light is reflected once.
ConductorBsdf metal(const ConductorMaterial& m, const Values& v) {
    ConductorBsdf b = bare_metal(m, v);
    b.film = v.film(m.film);
    return b;
}

Bsdf make(const ConductorMaterial& m, const Values& v, const Tables& tables) {
    const ConductorBsdf b = metal(m, v);
    return m.multiple_scattering ? with_multiple_scattering(b, *tables.white) : b;
}

Bsdf make(const DielectricMaterial& m, const Values& v, const Tables& tables) {
    const Vec2 alpha = v.alphas(m);
    DielectricBsdf b{refractive_index(m.eta), alpha.x, alpha.y,
                     m.transmittance < 0 ? Rgb(1) : v.transmittance(), m.dispersion.get()};
    b.film = v.film(m.film);
    return m.multiple_scattering ? with_multiple_scattering(b, *tables.from_outside,
                                                            *tables.from_inside, tables.under_film)
                                 : b;
}

/// A coat that reflects or lets through all light, over a base.
CoatedDiffuseBsdf total_coat(const CoatedDiffuseMaterial& m, Rgb reflectance, const Values& v,
                             const Tables& tables) {
    const Vec2 alpha = v.alphas(m);
    if (m.multiple_scattering)
        return make_coated_total(*tables.coat, reflectance, alpha.x, alpha.y, {}, tables.white);
    CoatTint tint;
    if (tables.white) {
        tint = v.tint(m, tables.white);
        if (m.coat_dims_base) reflectance *= 1 - max_component(tint.normal_reflectance);
    }
    return make_coated_total(*tables.coat, reflectance, alpha.x, alpha.y, tint);
}

/// Optical depth of the gap of a coated model.
template <typename Material>
float gap_thickness(const Material& m, const Values& v) {
    const float thickness = v.number(m.thickness, kDefaultThickness);
    return thickness > 0 ? thickness : 0;
}

/// Medium in the gap of a coated model.
template <typename Material>
GapScattering gap_scattering(const Material& m, const Values& v, float thickness,
                             const Tables& tables) {
    if (!(thickness > 0)) return {};
    constexpr float kMostForward = 0.99f;  // beyond it light goes straight on
    const float g = v.number(m.g, 0);
    return {share(v.spectrum(m.albedo, 0)),
            std::isfinite(g) ? std::clamp(g, -kMostForward, kMostForward) : 0.0f,
            std::max(1, m.max_depth), tables.gap};
}

Bsdf make(const CoatedDiffuseMaterial& m, const Values& v, const Tables& tables) {
    if (m.reflects_through_coat) return total_coat(m, v.reflectance(), v, tables);
    const Vec2 alpha = v.alphas(m);
    if (m.scatters_in_gap()) {
        HazyDiffuseBsdf b;
        b.thickness = gap_thickness(m, v);
        b.gap = gap_scattering(m, v, b.thickness, tables);
        b.coat = {refractive_index(m.eta), alpha.x, alpha.y};
        b.base = {v.reflectance()};
        b.samples = std::max(1, m.samples);
        return b;
    }
    // The number of bounces is half of pbrt's depth, whose walk meets the base at every second of
    // its steps.
    return make_coated_diffuse(*tables.coat, v.powers_of_reflectance(), alpha.x, alpha.y,
                               (m.max_depth + 1) / 2);
}

/// Coefficients of a medium, of which sums and shares are numbers.
Rgb coefficients(Rgb c) {
    constexpr float kMost = 1e30f;
    c = at_least_0(c);
    return {std::min(c.r, kMost), std::min(c.g, kMost), std::min(c.b, kMost)};
}

Bsdf make(const SubsurfaceMaterial& m, const Values& v, const Tables& tables) {
    SubsurfaceBsdf b;
    b.refracts = m.refracts;
    b.border = total_coat(m.border, v.reflectance(), v, tables);
    if (m.refracts) {
        b.facet_eta = b.border.eta;
        b.facet_alpha_x = b.border.alpha_x;
        b.facet_alpha_y = b.border.alpha_y;
    } else {
        b.refracted_share = m.refracted_share;
        b.facet_eta = m.facet_eta;
        b.facet_alpha_x = b.facet_alpha_y = m.facet_alpha;
    }
    constexpr float kMostForward = 0.99f;  // beyond it light goes straight on
    b.g = std::clamp(v.number(m.g, 0), -kMostForward, kMostForward);
    const float inside = m.refracts ? inner_reflectance(b.border) : 0;
    const Entry entry = m.refracts ? Entry::perpendicular : Entry::diffuse;
    const Scattering s =
        m.border.reflectance >= 0
            ? scattering_of_reflectance(v.reflectance(),
                                        m.scale * at_least_0(v.spectrum(m.mean_free_path, 1)), b.g,
                                        inside, entry)
            : Scattering{coefficients(m.scale * v.spectrum(m.absorption, 0)),
                         coefficients(m.scale * v.spectrum(m.scattering, 0))};
    b.absorption = s.absorption;
    b.scattering = s.scattering;
    if (m.border.reflectance < 0)
        b.border =
            total_coat(m.border, reflectance_of_scattering(s, b.g, inside, entry), v, tables);
    return b;
}

Bsdf make(const DiffuseTransmissionMaterial&, const Values& v, const Tables&) {
    return DiffuseTransmissionBsdf{v.reflectance(), v.transmittance()};
}

Bsdf make(const CoatedConductorMaterial& m, const Values& v, const Tables& tables) {
    const Vec2 coat = v.alphas(m);
    CoatedConductorBsdf b;
    b.coat = {refractive_index(m.eta), coat.x, coat.y};
    b.metal = metal(m.conductor, v);
    b.metal.eta *= 1 / b.coat.eta;
    b.metal.k *= 1 / b.coat.eta;
    if (m.conductor.multiple_scattering) b.metal = with_multiple_scattering(b.metal, *tables.white);
    b.thickness = gap_thickness(m, v);
    // The number of bounces is half of pbrt's depth, whose walk meets the metal at every second of
    // its steps.
    b.bounces = std::max(1, (m.max_depth + 1) / 2);
    b.samples = std::max(1, m.samples);
    b.gap = gap_scattering(m, v, b.thickness, tables);
    return b;
}

Bsdf make(const ThinDielectricMaterial& m, const Values& v, const Tables& tables) {
    ThinDielectricBsdf pane{refractive_index(m.eta),
                            m.transmittance < 0 ? Rgb(1) : v.transmittance()};
    pane.film = v.film(m.film);
    if (!tables.white) return pane;
    const Vec2 alpha = v.alphas(m);
    pane.alpha_x = alpha.x;
    pane.alpha_y = alpha.y;
    return with_multiple_scattering(pane, *tables.white);
}

Bsdf make(const InterfaceMaterial&, const Values&, const Tables&) {
    return InterfaceBsdf{};
}

Bsdf make(const MeasuredMaterial&, const Values&, const Tables& tables) {
    return MeasuredBsdf{tables.measured};
}

Bsdf make(const UnlitMaterial& m, const Values& v, const Tables&) {
    return UnlitBsdf{v.spectrum(m.colour, 1), m.two_sided};
}

/// Absorption in a strand, by the first description that is given.
Rgb hair_absorption(const HairMaterial& m, const Values& v, float beta_n) {
    if (m.absorption >= 0) return at_least_0(v.spectrum(m.absorption, 0));
    if (m.reflectance >= 0) return absorption_of_reflectance(share(v.reflectance()), beta_n);
    constexpr float kDefaultEumelanin = 1.3f;
    if (m.eumelanin < 0 && m.pheomelanin < 0) return absorption_of_pigments(kDefaultEumelanin, 0);
    return absorption_of_pigments(at_least_0(v.number(m.eumelanin, 0)),
                                  at_least_0(v.number(m.pheomelanin, 0)));
}

Bsdf make(const HairMaterial& m, const Values& v, const Tables&) {
    HairShape shape;
    shape.beta_m = share(v.number(m.beta_m, shape.beta_m));
    shape.beta_n = share(v.number(m.beta_n, shape.beta_n));
    shape.alpha = v.number(m.alpha, shape.alpha);
    shape.eta = v.number(m.eta, shape.eta);
    shape.coat = share(v.number(m.coat, shape.coat));
    return make_hair(shape, hair_absorption(m, v, shape.beta_n));
}

}  // namespace

Bsdf make_bsdf(const MaterialDescription& material, const MaterialValues& values,
               const MaterialTables& tables) {
    Bsdf bsdf =
        std::visit([&](const auto& model) { return make(model, values, tables); }, material.value);
    put_under_layers(bsdf, material, values.textures, values.at, tables);
    return bsdf;
}

}  // namespace covtrace
