/// A recorded vertex as the operators of scattering see it: geometry, motion, textures.
#pragma once

#include <optional>

#include "covariance/covariance.hpp"
#include "integrator/lit_scene.h"
#include "integrator/path_record.h"
#include "texture/spectra.h"

namespace covtrace {

/// Geometry, motion and textures at a vertex, gathered once for all the light that meets there.
struct ScatterPoint {
    covariance::Surface<double> surface;  ///< the geometry, on which positions are measured
    /// Field of the normals that the BSDF faces, of the geometry or of a bump or normal map over
    /// it, turned where the vertex' frame is; empty on flat geometry without such a map.
    std::optional<covariance::NormalField<double>> normals;
    /// The surface with its tangents turned along with the normal, by a bump or normal map or for
    /// mirrored light; empty where nothing turns it.
    std::optional<covariance::Surface<double>> turned;
    std::optional<covariance::Motion<double>> motion;  ///< empty where nothing moves
    /// Spectra of the textures that scale the diffuse lobes, along surface.t1, t2, 1 / scene
    /// unit^2; zero where the recorded events have no such lobe.
    covariance::Sym2<double> reflectance, transmittance;
    const Frame& shading;  ///< frame of the BSDF
    /// The surface as the BSDF sees it.
    const covariance::Surface<double>& facing() const { return turned ? *turned : surface; }

    /// A frame along the direction in which light leaves towards the camera; its x and y are
    /// arbitrary.
    covariance::Frame<double> leaving;

    /// Gathers the data. `footprint`: half a pixel's extent at the vertex, in scene units; no
    /// texture edge counts as nearer. `vertex` must outlive this object.
    ScatterPoint(const LitScene& scene, const TextureSpectra& spectra, const PathVertex& vertex,
                 float footprint);

  private:
    ScatterPoint(const LitScene& scene, const TextureSpectra& spectra, const PathVertex& vertex,
                 float footprint, const DifferentialGeometry& geometry);
};

/// Spectrum of the image and the alpha of an emitter that was hit, along the axes of `tangent` (z:
/// its normal), 1 / scene unit^2. `footprint`: half a pixel's extent, in scene units.
covariance::Sym2<double> emission_texture(const LitScene& scene, const TextureSpectra& spectra,
                                          const PathVertex& vertex, const Frame& tangent,
                                          float footprint);

}  // namespace covtrace
