/// One scattering event: from the light that arrives at a surface to the light that leaves it.
#pragma once

#include "covariance/covariance.hpp"
#include "frequency/brdf_covariance.h"
#include "frequency/light_source.h"
#include "integrator/path_record.h"
#include "integrator/render_scene.h"

namespace covtrace {

/// A recorded vertex as the operators see it, gathered once for all the light that meets there.
struct ScatterPoint {
    covariance::Surface<double> surface;  ///< the geometry, on which positions are measured
    /// What the BSDF faces: the normals of a bump or normal map over the geometry, if there is one,
    /// and the surface with its tangents turned along.
    covariance::NormalField<double> normals;
    covariance::Surface<double> facing;
    covariance::Motion<double> motion;
    /// Spectra of the textures that scale the diffuse lobes, along surface.t1, t2, 1 / scene
    /// unit^2; zero where the recorded events have no such lobe.
    covariance::Sym2<double> reflectance, transmittance;
    Frame shading;  ///< frame of the BSDF
    Vec3 outgoing;  ///< unit, the direction in which light leaves towards the camera
};

/// `footprint`: half a pixel's extent at the vertex, in scene units; no texture edge counts as
/// nearer.
ScatterPoint scatter_point(const RenderScene& scene, const PathVertex& vertex, float footprint);

/// Spectrum of the image and the alpha of an emitter that was hit, along the axes of `tangent`
/// (z: its normal), 1 / scene unit^2. `footprint` as above.
covariance::Sym2<double> emission_texture(const RenderScene& scene, const PathVertex& vertex,
                                          const Frame& tangent, float footprint);

/// Sends `arriving` (its frame's z is the direction of travel towards the surface) through the
/// lobes of the event and merges them by luminance. `emitter`: where the light was last sent out.
/// The result travels along point.outgoing, in whatever frame.
/// Lobes with less than `least` of the event's light are left out, but for the brightest.
LightField scatter(const LightField& arriving, const covariance::Emitter<double>& emitter,
                   const ScatterPoint& point, const LobeShares& lobes, BrdfCovariance rule,
                   double least = 0);

}  // namespace covtrace
