/// Measured BRDFs whose truth is known: GGX metals that reflect everything, and a diffuse surface,
/// as tables.
#pragma once

#include <cmath>

#include "bsdf/bilinear_density.h"
#include "bsdf/ggx.h"
#include "scene/brdf_tensor.h"

namespace covtrace {

inline Vec3 at_angles(float theta, float phi) {
    return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}
/// The direction that stands at a place in the square of a measured BRDF.
inline Vec3 at_place(float u, float v) {
    return at_angles(u * u * (kPi / 2), (2 * v - 1) * kPi);
}

/// Tables with value(u, v) at their nodes.
template <typename Value>
void add_table(BrdfTables<float>& tables, const Value& value) {
    for (int y = 0; y < tables.height; ++y)
        for (int x = 0; x < tables.width; ++x)
            tables.values.push_back(
                value(float(x) / float(tables.width - 1), float(y) / float(tables.height - 1)));
}

/// A mirror of GGX microfacets. With one node of phi the alphas must be equal.
inline BrdfTensor ggx_tensor(float alpha_x, float alpha_y, int thetas, int phis, int size) {
    const Ggx ggx{alpha_x, alpha_y};
    BrdfTensor t;
    for (int i = 0; i < thetas; ++i)
        t.theta.push_back(float(i) / float(thetas - 1) * (kPi / 2) * 0.99f);
    for (int i = 0; i < phis; ++i)
        t.phi.push_back(phis == 1 ? 0 : -kPi + 2 * kPi * float(i) / float(phis - 1));
    t.normals = {size, size, {}};
    add_table(t.normals, [&](float u, float v) { return ggx.d(at_place(u, v)); });
    t.areas = {size, size, {}};
    add_table(t.areas, [&](float u, float v) {
        const Vec3 w = at_place(u, v);
        return (w.z + ggx.stretched_length(w)) / 2;
    });
    t.visible_normals = {size, size, {}};
    t.luminance = {size / 2, size / 2, {}};
    t.colours = {size / 2, size / 2, {}};
    size_t table = 0;
    for (const float phi : t.phi)
        for (const float theta : t.theta) {
            const Vec3 wo = at_angles(theta, phi);
            const auto normal = [&](float u, float v) {
                return at_angles(u * u * (kPi / 2), (2 * v - 1) * kPi + (phis == 1 ? phi : 0));
            };
            BrdfTables<float> seen{size, size, {}};
            add_table(seen, [&](float u, float v) {
                const Vec3 m = normal(u, v);
                return ggx.d(m) * std::max(0.0f, dot(wo, m)) * u * std::hypot(m.x, m.y);
            });
            const BilinearDensity density(size, size, seen.values);
            t.visible_normals.values.insert(t.visible_normals.values.end(), seen.values.begin(),
                                            seen.values.end());
            add_table(t.luminance, [&](float x, float y) {
                const Vec2 place = density.sample({x, y}, {{0}, {1}, 1}).place;
                const Vec3 m = normal(place.x, place.y);
                const Vec3 wi = 2 * dot(wo, m) * m - wo;
                return wi.z > 0 ? ggx.g2_over_g1(wo, wi) : 0.0f;
            });
            ++table;
        }
    for (const float v : t.luminance.values)
        t.colours.values.push_back(Rgb(v, 0.5f * v, 0.25f * v));
    return t;
}

/// A diffuse surface: microfacet normals and places in the square are the same, and the factors
/// undo what the tables of microfacets do to the BRDF.
inline BrdfTensor diffuse_tensor(Rgb reflectance) {
    constexpr int kSize = 64, kThetas = 16;
    BrdfTensor t;
    for (int i = 0; i < kThetas; ++i) t.theta.push_back(float(i) / (kThetas - 1) * (kPi / 2));
    t.phi = {0};
    t.normals = t.areas = {2, 2, {1, 1, 1, 1}};
    t.visible_normals = {2, 2, std::vector<float>(4 * kThetas, 1.0f)};
    t.luminance = {kSize, kSize, {}};
    t.colours = {kSize, kSize, {}};
    for (const float theta : t.theta) {
        const Vec3 wo = at_angles(theta, 0);
        add_table(t.luminance, [&](float u, float v) {
            const Vec3 m = at_place(u, v);
            return std::max(0.0f, 2 * dot(wo, m) * m.z - wo.z) * (4 * kInvPi);
        });
    }
    for (const float v : t.luminance.values) t.colours.values.push_back(v * reflectance);
    return t;
}

}  // namespace covtrace
