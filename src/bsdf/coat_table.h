/// A dielectric coat over a Lambertian base: the shares of light that it reflects and lets through.
///
/// The model is pbrt-v4's layered walk: a (rough) dielectric interface, a gap of the given
/// thickness that weakens light by A(w) = exp(-thickness / |w.z|) at each crossing, and a
/// Lambertian base of reflectance rho. Since the base forgets directions, the walk has a closed
/// form:
///
/// 1. Let f_t be the interface's BTDF for energy (without the radiance factor). Of the light from
///    direction w outside, the share T(w) = integral f_t(w, v) |v.z| A(v) dv reaches the base, so
///    radiance L from wi within dwi gives it the irradiance E = L |wi.z| T(wi) dwi.
/// 2. The base sends out the radiance rho E / pi in all directions. The share
///    R_int = (1 / pi) integral |v.z| A(v) integral f_r(v, v') |v'.z| A(v') dv' dv
///    of that flux comes back from the interface's inside and is reflected again. After n
///    reflections at the base its radiance is L_b = (rho E / pi) sum_{j<n} (rho R_int)^j.
/// 3. Outside, along wo, arrives integral f_t'(wo, v) L_b A(v) |v.z| dv, where f_t' transports
///    radiance. From outside to inside f_t' = f_t / eta^2 (reciprocity of f_t / eta^2: the solid
///    angle of a bundle is eta^2 times larger outside), hence L_o = L_b T(wo) / eta^2.
///
///    f(wo, wi) = f_coat(wo, wi) + T(wo) T(wi) rho / (pi eta^2) sum_{j<n} (rho R_int)^j
///
/// which is reciprocal. n is half of pbrt's `maxdepth`, rounded up.
///
/// The tables hold isotropic coats. An anisotropic one is looked up, for each direction w, at the
/// roughness alpha^2 = alpha_x^2 w.x^2 + alpha_y^2 w.y^2 + w.z^2 (alpha_x^2 + alpha_y^2) / 2: that
/// of the plane of incidence at grazing angles, the mean of both at the normal.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "bsdf/bsdf.h"
#include "colour/reflectance_powers.h"
#include "core/catmull_rom.h"

namespace covtrace {

/// Tables of T, of the coat's own albedo and of R_int over roughness and angle, for one (eta,
/// thickness).
class CoatTable {
  public:
    /// Fills the tables by quadrature; takes about 40 ms. `eta`: coat over outside, > 0.
    CoatTable(float eta, float thickness);
    /// The table of a border without a gap that gives back the light that meets several of its
    /// facets (multiple_scattering.h): `reflection` holds it, and `transmission` is all else.
    /// `white`: table of kWhiteIndex without a gap.
    CoatTable(float eta, const CoatTable& white);
    float eta() const { return eta_; }
    float thickness() const { return thickness_; }

    static constexpr int kRows = 24;   ///< over sqrt(alpha) in [0, 1]
    static constexpr int kNodes = 48;  ///< over sqrt(cos) in [0, 1]
    /// Coordinate of a roughness alpha among the rows; alphas above 1 are looked up at 1.
    static float row_of(float alpha) { return std::sqrt(clamp01(alpha)) * (kRows - 1); }
    /// The same for the mean roughness of an anisotropic border.
    static float row_of(float alpha_x, float alpha_y) {
        return row_of(std::sqrt(0.5f * (sqr(alpha_x) + sqr(alpha_y))));
    }

    /// Values at the nodes of each row, with one node more at either end for the cubic
    /// interpolation.
    template <typename T>
    using PerAngle = std::array<std::array<T, kNodes + 2>, kRows>;
    /// The place of a direction in a table: between rows values are interpolated linearly, between
    /// nodes by Catmull-Rom.
    class Place {
      public:
        Place(float row, float cos_theta);
        /// The interpolated `value(entry)`, a number or a colour, of the entries around the place.
        template <typename T, typename Value>
        auto interpolate(const PerAngle<T>& table, const Value& value) const {
            const auto along = [&](int row) {
                const T* at = table[row].data() + node_;
                return value(at[0]) * weights_[0] + value(at[1]) * weights_[1] +
                       value(at[2]) * weights_[2] + value(at[3]) * weights_[3];
            };
            return along(row_) * (1 - of_next_row_) + along(row_ + 1) * of_next_row_;
        }

      private:
        int row_, node_;
        float of_next_row_;
        std::array<float, 4> weights_;
    };
    /// Fills the nodes beyond both ends of a row: as of an even function of sqrt(cos) at grazing
    /// angles, and of a linear one past the normal.
    template <typename T>
    static void continue_past_ends(std::array<T, kNodes + 2>& nodes) {
        nodes[0] = nodes[2];
        nodes[kNodes + 1] = 2.0f * nodes[kNodes] - nodes[kNodes - 1];
    }
    /// Shares of the light that arrives from outside.
    struct Shares {
        float transmission;  ///< share that reaches the base: T
        float reflection;    ///< share that the interface reflects
        friend Shares operator*(float k, Shares s) {
            return {k * s.transmission, k * s.reflection};
        }
        friend Shares operator-(Shares a, Shares b) {
            return {a.transmission - b.transmission, a.reflection - b.reflection};
        }
    };
    /// The shares of light from a direction with cosine `cos_theta` > 0.
    Shares shares(float row, float cos_theta) const;
    /// Share of the base's flux that the coat sends back to it: R_int.
    float internal_reflectance(float row) const { return lookup(internal_reflectance_, row); }
    /// Cosine-weighted mean of `reflection` over the hemisphere.
    float mean_reflection(float row) const { return lookup(mean_reflection_, row); }
    /// Cosine-weighted mean of T over the hemisphere.
    float mean_transmission(float row) const { return lookup(mean_transmission_, row); }
    /// Whether the table is of the second kind.
    bool gives_back() const { return gives_back_; }
    /// Share of the light lost by a first reflection that comes back later; 0 but for the second
    /// kind of table.
    float regained(float row) const { return lookup(regained_, row); }

  private:
    using PerRow = std::array<float, kRows>;
    static float lookup(const PerRow& values, float row);

    float eta_, thickness_;
    bool gives_back_ = false;
    PerAngle<Shares> shares_;
    PerRow internal_reflectance_, mean_transmission_, mean_reflection_, regained_{};
};

/// Makes glTF's and Blender's diffuse under specular: of the light that the coat doesn't reflect (1
/// - E, with E its directional albedo) the share `reflectance` leaves again, whatever goes on
/// inside. Reciprocal and complete for E(wo) and its cosine-weighted mean,
///
///    f(wo, wi) = f_coat(wo, wi) + (1 - E(wo)) (1 - E(wi)) reflectance / (pi (1 - mean E))
///
/// (Kelemen and Szirmay-Kalos 2001, "A microfacet based coupled specular-matte BRDF model with
/// importance sampling"), so white reflects all light at any roughness. For a smooth coat without a
/// gap this is the layered model with the base rho = reflectance / (1 - R_int + R_int reflectance);
/// for a rough one it keeps the light that single scattering loses. The table's thickness doesn't
/// count. Of a coat with a tint, E is the albedo in the channel that reflects most, so that the
/// base keeps the hue of `reflectance`, as KHR_materials_specular has it.
///
/// With `white`, table of kWhiteIndex without a gap, f_coat has the gain of multiple_scattering.h
/// for wo, which is the border's only part that is not reciprocal; `table` is then of the second
/// kind, and there is no tint.
CoatedDiffuseBsdf make_coated_total(const CoatTable& table, Rgb reflectance, float alpha_x,
                                    float alpha_y, const CoatTint& tint = {},
                                    const CoatTable* white = nullptr);

/// Cosine to the facets of a rough border by which light is reflected, in the mean: where Schlick's
/// formula gives the share `fresnel` that it reflects of what a white one does, `white`.
inline float facet_cosine(float eta, float fresnel, float white) {
    const float f0 = sqr((eta - 1) / (eta + 1));
    return 1 - std::pow(clamp01((fresnel / white - f0) / (1 - f0)), 0.2f);
}

/// Share that a tinted coat reflects of the light that meets its facets with the given cosine.
/// `fresnel`: that of its border of index `eta` without tint; `white`: that of a white border.
inline Rgb tinted(const CoatTint& tint, float eta, float cosine, float fresnel, float white) {
    const float f0 = sqr((eta - 1) / (eta + 1));
    // x in place of F; rounding must not take it below 0.
    const float grown = std::max(0.0f, (fresnel - f0 * white) / (1 - f0));
    const Rgb bare = tint.normal_reflectance * (white - grown) + Rgb(grown);
    if (!(tint.film.weight > 0)) return tint.weight * bare;
    // Light that a rough border loses by single scattering is lost of the film's share, too.
    const Rgb film = white * film_reflectance(tint.film, cosine, tint.normal_reflectance);
    return tint.weight * lerp(tint.film.weight, bare, film);
}

/// The same of a rough coat, for the light along a direction with the cosine `cos_theta` > 0;
/// `table`: of the border without tint.
inline Rgb tinted(const CoatTint& tint, float eta, const CoatTable& table, float row,
                  float cos_theta) {
    const float fresnel = table.shares(row, cos_theta).reflection,
                white = tint.white->shares(row, cos_theta).reflection;
    const float cosine = tint.film.weight > 0 ? facet_cosine(eta, fresnel, white) : cos_theta;
    return tinted(tint, eta, cosine, fresnel, white);
}

/// Index of a border that reflects everything, as far as single precision tells: CoatTint::white.
inline constexpr float kWhiteIndex = 1e6f;

/// The tables of all coats of a scene, one for each distinct pair (eta, thickness).
class CoatTables {
  public:
    /// Makes the table where it does not exist yet; the reference lives as long as this object.
    const CoatTable& get(float eta, float thickness);
    /// The same of the second kind of table.
    const CoatTable& get_bouncing(float eta);

  private:
    std::vector<std::unique_ptr<const CoatTable>> tables_;
};

/// Makes the layered model. `base`: rho and its powers, each the colour of its spectrum. `bounces`:
/// most reflections at the base. The alphas are both 0 (a smooth coat) or both > 0.
CoatedDiffuseBsdf make_coated_diffuse(const CoatTable& table, const ReflectancePowers& base,
                                      float alpha_x, float alpha_y, int bounces);

inline float CoatTable::lookup(const PerRow& values, float row) {
    const int i = std::min(static_cast<int>(row), kRows - 2);
    const float t = row - static_cast<float>(i);
    return values[i] * (1 - t) + values[i + 1] * t;
}

inline CoatTable::Place::Place(float row, float cos_theta) {
    const float x = std::sqrt(clamp01(cos_theta)) * (kNodes - 1);
    node_ = std::min(static_cast<int>(x), kNodes - 2);
    weights_ = catmull_rom_weights(x - static_cast<float>(node_));
    row_ = std::min(static_cast<int>(row), kRows - 2);
    of_next_row_ = row - static_cast<float>(row_);
}

inline CoatTable::Shares CoatTable::shares(float row, float cos_theta) const {
    const Place place(row, cos_theta);
    return {place.interpolate(shares_, [](const Shares& s) { return s.transmission; }),
            place.interpolate(shares_, [](const Shares& s) { return s.reflection; })};
}

}  // namespace covtrace
