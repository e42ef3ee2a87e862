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
    bool is_flat = false;  ///< no curvature, no normal map, no motion
    /// Spectra of the textures that scale the diffuse lobes, along surface.t1, t2, 1 / scene
    /// unit^2; zero where the recorded events have no such lobe.
    covariance::Sym2<double> reflectance, transmittance;
    Frame shading;  ///< frame of the BSDF
    Vec3 outgoing;  ///< unit, the direction in which light leaves towards the camera

    /// `footprint`: half a pixel's extent at the vertex, in scene units; no texture edge counts as
    /// nearer.
    ScatterPoint(const RenderScene& scene, const PathVertex& vertex, float footprint);
};

/// Spectrum of the image and the alpha of an emitter that was hit, along the axes of `tangent`
/// (z: its normal), 1 / scene unit^2. `footprint` as above.
covariance::Sym2<double> emission_texture(const RenderScene& scene, const PathVertex& vertex,
                                          const Frame& tangent, float footprint);

/// The light that leaves a vertex towards the camera: the sum, by luminance, of what all lobes of
/// all events there send on. Leaving is linear and the same for all of it, so it is done once.
class ScatterSum {
  public:
    /// `point` must outlive this.
    explicit ScatterSum(const ScatterPoint& point) : point_(point) {}

    /// Sends `arriving` (its frame's z is the direction of travel towards the surface) through the
    /// lobes of an event and adds what comes out of them, `weight` in all. `emitter`: where the
    /// light was last sent out. Lobes with less than `least` of the event's light are left out, but
    /// for the brightest.
    void add(const LightField& arriving, const covariance::Emitter<double>& emitter,
             const LobeShares& lobes, double weight, BrdfCovariance rule, double least = 0);

    double weight() const { return weight_; }
    /// Travels along point.outgoing, in whatever frame. Only where the weight is above 0.
    LightField leaving() const;

  private:
    void add(const LightField& left, double weight);

    const ScatterPoint& point_;
    LightField through(const LightField& entered, const covariance::Emitter<double>& emitter,
                       const LobeShare& lobe, BrdfCovariance rule);
    LightField through_diffuse(const LightField& entered,
                               const covariance::Emitter<double>& emitter, const LobeShare& lobe,
                               BrdfCovariance rule);

    /// What the coat over a diffuse lobe lets out, computed when it is first needed.
    struct CoatWindow {
        float eta = 0;
        covariance::Sym2<double> window;
    };

    CoatWindow let_out_;
    LightField left_;  ///< between surface_enter and surface_exit
    double weight_ = 0;
};

}  // namespace covtrace
