/// A measured BRDF, ready to be evaluated and sampled as pbrt-v4 does.
///
/// Dupuy and Jakob 2018, "An adaptive parameterization for efficient material acquisition and
/// rendering": the unit square is mapped to the microfacet normals that the viewer sees, by their
/// tabulated density, and these to the directions that they reflect to. Over the square the BRDF is
/// smooth, and a second density, about that of its luminance, chooses there.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "bsdf/bilinear_density.h"
#include "bsdf/bsdf.h"
#include "scene/brdf_tensor.h"

namespace covtrace {

class MeasuredBrdf {
  public:
    /// The tensor's sizes must fit together, as those of a reader do.
    explicit MeasuredBrdf(const BrdfTensor& tensor);

    // As those of bsdf.h, for directions above the surface.
    Rgb eval(Vec3 wo, Vec3 wi) const;
    float pdf(Vec3 wo, Vec3 wi) const;
    std::optional<BsdfSample> sample(Vec3 wo, Vec2 u) const;
    Rgb albedo(Vec3 wo) const;

    /// Roughness of the GGX distribution with the same density of normals along the surface's own,
    /// by which the prediction knows the lobe.
    float alpha() const { return alpha_; }
    /// Whether the normals are spread so widely that the surface counts as diffuse there.
    bool is_wide() const { return alpha_ > 0.7f; }

  private:
    /// A viewer's direction among the tables.
    struct View {
        float phi = 0, theta = 0;
        TableWeights weights;
    };
    View view(Vec3 wo) const;
    /// Place of a microfacet normal in the square, for this viewer.
    Vec2 place_of(Vec3 normal, const View& view) const;
    /// The BRDF times the cosine for a normal's place and the place in the square that it is the
    /// image of.
    Rgb value(Vec2 normal, Vec2 place, const View& view) const;

    std::vector<float> phi_, theta_;
    bool is_isotropic_ = false;
    BrdfTables<float> normals_, areas_;
    BilinearDensity visible_normals_, luminance_;
    BrdfTables<Rgb> colours_;
    float alpha_ = 1;
    std::vector<Rgb> albedo_;  // by theta_
};

}  // namespace covtrace
