/// Anisotropic GGX (Trowbridge-Reitz) microfacets with height-correlated Smith masking.
///
/// All directions are unit vectors in the local frame with z > 0; callers mirror the lower side.
/// Functions over V take Vec3, and vectors of scalars that carry derivatives (lobe_function.h).
/// With s(w) = sqrt(w.z^2 + alpha_x^2 w.x^2 + alpha_y^2 w.y^2), Smith's Lambda is (s / w.z - 1) /
/// 2, so masking needs no tangents and stays finite at grazing angles.
///
/// Light that would meet a second microfacet is lost, as in pbrt, but where a material gets it back
/// (multiple_scattering.h). Of uniform light from all directions a GGX mirror that absorbs nothing
/// keeps 0.97 for alpha = 0.1, 0.84 for 0.3, 0.69 for 0.5 and 0.40 for 1; a border of index 1.5
/// keeps 0.99, 0.96, 0.92, 0.79 from outside and 0.96, 0.82, 0.69, 0.48 from inside (lower bounds,
/// checked in tests/statistical/bsdf_furnace_test.cpp).
///
/// Source: Walter et al. 2007, "Microfacet models for refraction through rough surfaces"
/// (distribution, half vectors); Heitz 2014, "Understanding the masking-shadowing function in
/// microfacet-based BRDFs" (masking); Heitz 2018, "Sampling the GGX distribution of visible
/// normals", and Dupuy and Benyoub 2023, "Sampling visible GGX normals with spherical caps".
#pragma once

#include <cmath>

#include "core/fast_math.h"
#include "core/vec.h"

namespace covtrace {

struct Ggx {
    float alpha_x = 0, alpha_y = 0;  ///< both > 0

    /// Density of microfacet normals: the integral of d(m) m.z over the hemisphere is 1.
    template <typename V>
    auto d(const V& m) const {
        const auto x = m.x / alpha_x, y = m.y / alpha_y;
        const auto e = x * x + y * y + m.z * m.z;
        return kInvPi / (alpha_x * alpha_y * e * e);
    }
    /// Density d at the normal h / |h|, from h of any length.
    template <typename V, typename S>
    S d_along(const V& h, const S& length_squared) const {
        const S x = h.x / alpha_x, y = h.y / alpha_y;
        const S ratio = length_squared / (x * x + y * y + h.z * h.z);
        return kInvPi / (alpha_x * alpha_y) * (ratio * ratio);
    }
    /// Length s(w) of w after stretching the surface to roughness one; see the head of this file.
    template <typename V>
    auto stretched_length(const V& w) const {
        using std::sqrt;
        const auto x = alpha_x * w.x, y = alpha_y * w.y;
        return sqrt(w.z * w.z + x * x + y * y);
    }
    /// Share of the microfacets facing w that are visible from w.
    float g1(Vec3 w) const { return 2 * w.z / (w.z + stretched_length(w)); }
    /// Share of the microfacets visible from both directions, over wo.z.
    template <typename O, typename I>
    auto g2_over_cos_o(const O& wo, const I& wi) const {
        return 2 * wi.z / (stretched_length(wo) * wi.z + stretched_length(wi) * wo.z);
    }
    /// The ratio g2(wo, wi) / g1(wo): the share of a sampled normal's light that single scattering
    /// keeps.
    float g2_over_g1(Vec3 wo, Vec3 wi) const {
        const float so = stretched_length(wo), si = stretched_length(wi);
        return wi.z * (wo.z + so) / (so * wi.z + si * wo.z);
    }
    /// Density, per solid angle of m, of the normals that are seen from wo.
    float visible_normal_pdf(Vec3 wo, Vec3 m) const {
        return 2 * std::max(0.0f, dot(wo, m)) * d(m) / (wo.z + stretched_length(wo));
    }
    /// Density, per solid angle of the mirrored direction, of reflecting wo at a visible normal m.
    float reflection_pdf(Vec3 wo, Vec3 m) const {
        return d(m) / (2 * (wo.z + stretched_length(wo)));
    }
    /// A normal with density `visible_normal_pdf`, by a spherical cap about the stretched wo.
    Vec3 sample_visible_normal(Vec3 wo, Vec2 u) const {
        const Vec3 w = Vec3{alpha_x * wo.x, alpha_y * wo.y, wo.z} / stretched_length(wo);
        // The cap's point is c with c.z = (1 - u.y)(1 + w.z) - w.z; the normal is c + w. Its z and
        // 1 - c.z are written without the cancelling terms.
        const SinCos phi = sin_cos(2 * kPi * u.x);
        const float h_z = (1 - u.y) * (1 + w.z);
        const float sin_c = safe_sqrt((1 + w.z) * u.y * (1 - w.z + h_z));
        return normalize(
            {alpha_x * (sin_c * phi.cos + w.x), alpha_y * (sin_c * phi.sin + w.y), h_z});
    }
};

}  // namespace covtrace
