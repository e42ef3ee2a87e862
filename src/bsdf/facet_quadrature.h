/// Quadrature over the facets of a rough border that light from one direction meets.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "bsdf/fresnel.h"
#include "bsdf/ggx.h"

namespace covtrace {

/// Nodes and weights on [0, 1], dense at both ends: evenly spaced s for x = sin^2(pi s / 2), which
/// makes integrands smooth that go like a square root at an end. The first s is `offset`, in (0,
/// 1), of their distance; in the middle of it as a rule.
template <int n>
struct Quadrature {
    std::array<float, n> x, weight;
    explicit Quadrature(double offset = 0.5) {
        double sum = 0;
        for (int i = 0; i < n; ++i) sum += std::sin(M_PI * (i + offset) / n);
        for (int i = 0; i < n; ++i) {
            const double angle = M_PI * (i + offset) / n;
            x[i] = static_cast<float>((1 - std::cos(angle)) / 2);
            weight[i] = static_cast<float>(std::sin(angle) / sum);
        }
    }
};

/// Nodes on the unit square that visible normals are sampled from. Azimuths cover one half of it,
/// as both sides of the plane of incidence are alike. Each has polar angles of its own, so that the
/// edge of total reflection, a circle about wo, lies between them in as many ways: shares are
/// within 0.5 %.
struct FacetNodes {
    static constexpr int kAzimuths = 24, kPolar = 16;
    std::vector<Quadrature<kPolar>> of_azimuth;
    FacetNodes() {
        for (int i = 0; i < kAzimuths; ++i) of_azimuth.emplace_back((i + 0.5) / kAzimuths);
    }
};

/// Facets of one normal, as light from a given direction meets them.
struct MetFacet {
    float weight;  ///< share of the light that meets them
    float cosine;  ///< of that light to them, > 0
    DielectricFresnel fresnel;
    /// Cosines to the border's normal of the directions that light is reflected and transmitted
    /// to; at most 0 where it would have to meet another facet.
    float cos_reflected = 0, cos_transmitted = 0;
    /// Shares of the reflected and of the transmitted light that no other facets mask.
    float kept_reflected = 0, kept_transmitted = 0;
};

/// Calls `visit(MetFacet)` for the nodes of a border with the given index beyond it over that on
/// the light's side, and the width `alpha` > 0; the light's cosine is `cos_o` > 0. The weights sum
/// to 1.
template <typename Visit>
void for_each_facet(float eta, float alpha, float cos_o, const Visit& visit) {
    static const FacetNodes nodes;
    const Ggx ggx{alpha, alpha};
    const Vec3 wo{safe_sqrt(1 - cos_o * cos_o), 0, cos_o};
    for (int i = 0; i < FacetNodes::kAzimuths; ++i) {
        const auto& polar = nodes.of_azimuth[static_cast<size_t>(i)];
        const float azimuth = (static_cast<float>(i) + 0.5f) / (2 * FacetNodes::kAzimuths);
        for (int j = 0; j < FacetNodes::kPolar; ++j) {
            const Vec3 m = ggx.sample_visible_normal(wo, {azimuth, polar.x[j]});
            const float cos_m = dot(wo, m);
            if (!(cos_m > 0)) continue;
            MetFacet facet{polar.weight[j] / FacetNodes::kAzimuths, cos_m,
                           fresnel_dielectric(cos_m, eta)};
            const Vec3 r = m * (2 * cos_m) - wo;
            facet.cos_reflected = r.z;
            if (r.z > 0) facet.kept_reflected = ggx.g2_over_g1(wo, r);
            if (facet.fresnel.reflectance < 1) {
                const Vec3 t = wo / eta - m * (cos_m / eta - facet.fresnel.cos_t);
                facet.cos_transmitted = t.z;
                if (t.z > 0) facet.kept_transmitted = ggx.g2_over_g1(wo, {-t.x, -t.y, t.z});
            }
            visit(facet);
        }
    }
}

}  // namespace covtrace
