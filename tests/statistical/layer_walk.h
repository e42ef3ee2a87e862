/// Light that walks by chance between a coat, the medium in the gap below it and a base: what the
/// models of coats must agree with.
///
/// Written from the models' description, with borders of its own: normals sampled from the whole
/// distribution (Walter et al., "Microfacet models for refraction through rough surfaces", EGSR
/// 2007, equations 35 and 36), Smith masking by tangents, complex Fresnel, all in double. It shares
/// no code with src/bsdf but the random numbers, follows light one way only, and finds directions
/// by chance, so that there are no weights to be wrong.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>

#include "core/rng.h"

namespace covtrace {

struct Direction {
    double x = 0, y = 0, z = 1;
};
inline double dot(const Direction& a, const Direction& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// Widths of the GGX of a border; 0: a smooth one.
struct Roughness {
    double alpha_x = 0, alpha_y = 0;
    bool is_smooth() const { return alpha_x == 0 && alpha_y == 0; }
};

/// A coat of index `eta` over a base: a Lambertian one that reflects all light, or a metal.
struct Layers {
    double eta = 1.5;
    Roughness coat;
    double thickness = 0.01;     ///< of the gap, in optical depths
    bool is_hazy = false;        ///< whether the gap scatters all light, or absorbs it
    double g = 0;                ///< mean cosine of what is scattered
    int bounces = 1000;          ///< most meetings of the base
    bool is_metal = false;       ///< whether the base is the metal of
    std::complex<double> index;  ///< over the coat's
    Roughness metal;
};

/// Light that has left: the share that is left of it, and how often it was scattered in the gap and
/// met the base.
struct LightExit {
    Direction way;
    double weight = 1;
    int scatterings = 0, at_base = 0;
};

template <typename Index>
double fresnel(double cos_i, Index eta) {
    const std::complex<double> cos_t =
        std::sqrt(std::complex<double>(1.0) - (1 - cos_i * cos_i) / (eta * eta));
    return (std::norm((eta * cos_i - cos_t) / (eta * cos_i + cos_t)) +
            std::norm((cos_i - eta * cos_t) / (cos_i + eta * cos_t))) /
           2;
}

inline double smith_lambda(const Roughness& r, const Direction& w) {
    const double tan2 =
        (r.alpha_x * r.alpha_x * w.x * w.x + r.alpha_y * r.alpha_y * w.y * w.y) / (w.z * w.z);
    return (std::sqrt(1 + tan2) - 1) / 2;
}

/// A normal of a border's facets, of all that there are.
inline Direction facet_normal(const Roughness& r, Rng& rng) {
    if (r.is_smooth()) return {};
    const double u = rng.next_float(), phi = 2 * M_PI * rng.next_float();
    const double radius = std::sqrt(u / (1 - u));
    const Direction slope{r.alpha_x * radius * std::cos(phi), r.alpha_y * radius * std::sin(phi),
                          1};
    const double length = std::sqrt(dot(slope, slope));
    return {slope.x / length, slope.y / length, 1 / length};
}

/// The share of light along `before` that single scattering by facets of normal m leaves in
/// `after`.
inline double kept_by_facets(const Roughness& r, const Direction& before, const Direction& after,
                             const Direction& m) {
    if (r.is_smooth()) return 1;
    return std::abs(dot(before, m)) / (1 + smith_lambda(r, before) + smith_lambda(r, after)) /
           std::abs(before.z * m.z);
}

/// Follows light along `d` to the coat and beyond; `weight` takes the share that single scattering
/// keeps.
inline void meet_coat(const Layers& l, Direction& d, double& weight, Rng& rng) {
    const bool from_above = d.z < 0;
    const double eta = from_above ? l.eta : 1 / l.eta, side = from_above ? 1 : -1;
    Direction m = facet_normal(l.coat, rng);
    m = {m.x * side, m.y * side, m.z * side};
    const double cos_i = -dot(d, m);
    if (cos_i <= 0) {
        weight = 0;
        return;
    }
    const Direction before = d;
    const bool reflects = rng.next_float() < fresnel(cos_i, eta);
    if (reflects) {
        d = {d.x + 2 * cos_i * m.x, d.y + 2 * cos_i * m.y, d.z + 2 * cos_i * m.z};
    } else {
        const double cos_t = std::sqrt(1 - (1 - cos_i * cos_i) / (eta * eta));
        const double along = cos_i / eta - cos_t;
        d = {d.x / eta + along * m.x, d.y / eta + along * m.y, d.z / eta + along * m.z};
    }
    if (reflects ? d.z * side <= 0 : d.z * side >= 0) {
        weight = 0;
        return;
    }
    weight *= kept_by_facets(l.coat, before, d, m);
}

/// The same for the base, which is met from above.
inline void meet_base(const Layers& l, Direction& d, double& weight, Rng& rng) {
    if (!l.is_metal) {
        const double cos2 = rng.next_float(), phi = 2 * M_PI * rng.next_float();
        const double sine = std::sqrt(1 - cos2);
        d = {sine * std::cos(phi), sine * std::sin(phi), std::sqrt(cos2)};
        if (d.z == 0) weight = 0;
        return;
    }
    const Direction m = facet_normal(l.metal, rng), before = d;
    const double cos_i = -dot(d, m);
    d = {d.x + 2 * cos_i * m.x, d.y + 2 * cos_i * m.y, d.z + 2 * cos_i * m.z};
    if (cos_i <= 0 || d.z <= 0) {
        weight = 0;
        return;
    }
    weight *= fresnel(cos_i, l.index) * kept_by_facets(l.metal, before, d, m);
}

/// The direction of light along d that a medium of Henyey and Greenstein's phase function scatters.
inline Direction scatter_in_gap(double g, const Direction& d, Rng& rng) {
    const double u = rng.next_float(), phi = 2 * M_PI * rng.next_float();
    const double part = (1 - g * g) / (1 - g + 2 * g * u);
    const double cosine = g == 0 ? 1 - 2 * u : (1 + g * g - part * part) / (2 * g);
    const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    const double across = std::sqrt(d.x * d.x + d.y * d.y);
    // About the z axis: s points to the side, t downwards along the meridian.
    const Direction s = across > 0 ? Direction{-d.y / across, d.x / across, 0} : Direction{1, 0, 0};
    const Direction t{d.y * s.z - d.z * s.y, d.z * s.x - d.x * s.z, d.x * s.y - d.y * s.x};
    const double a = sine * std::cos(phi), b = sine * std::sin(phi);
    return {a * s.x + b * t.x + cosine * d.x, a * s.y + b * t.y + cosine * d.y,
            a * s.z + b * t.z + cosine * d.z};
}

/// Follows light along `d`, downwards, until it leaves; none where it is lost.
inline std::optional<LightExit> follow_light(const Layers& l, const Direction& d, Rng& rng) {
    constexpr int kMostEvents = 200;
    LightExit light{d};
    double depth = 0;
    meet_coat(l, light.way, light.weight, rng);
    bool is_outside = light.way.z > 0;
    for (int event = 0; light.weight > 0 && !is_outside; ++event) {
        if (event == kMostEvents) return {};
        const double slope = -light.way.z;
        if (l.is_hazy) {
            depth -= std::log1p(-double(rng.next_float())) * slope;
            if (depth > 0 && depth < l.thickness) {
                light.way = scatter_in_gap(l.g, light.way, rng);
                ++light.scatterings;
                continue;
            }
        } else {
            light.weight *= std::exp(-l.thickness / std::abs(slope));
        }
        depth = slope > 0 ? l.thickness : 0;
        if (slope > 0) {
            if (++light.at_base > l.bounces) return {};
            meet_base(l, light.way, light.weight, rng);
        } else {
            meet_coat(l, light.way, light.weight, rng);
            is_outside = light.way.z > 0;
        }
    }
    if (!(light.weight > 0)) return {};
    return light;
}

}  // namespace covtrace
