/// From a recorded path to its covariance at the sensor: the only place that knows both sides.
#pragma once

#include "covariance/covariance.hpp"
#include "frequency/brdf_covariance.h"
#include "frequency/light_source.h"
#include "frequency/occlusion.h"
#include "integrator/path_record.h"
#include "integrator/render_scene.h"

namespace covtrace {

/// A path's covariance over (pixel x, pixel y, lens, lens, shutter) and its weight, the luminance
/// of all light that the record holds. Weight 0: no light, or a matrix that is not finite.
struct PathCovariance {
    covariance::SymmetricMatrix5<double> sigma;
    double weight = 0;
};

/// Which of a path's light is followed. Emitters in view (PathVertex::in_view) and the light that
/// they shed on surfaces have spectra, and contrasts, of their own.
enum class LightPart { all, in_view, scattered };

/// Walks the path once from its far end to the sensor. At every vertex the light found there (its
/// own emission, a sampled light) and the light that arrives from further on are merged by
/// luminance (an incoherent sum, covariance::merge), so that k vertices cost k steps.
class PathReplay {
  public:
    /// What is given must outlive this.
    PathReplay(const RenderScene& scene, const Occluders& occluders, BrdfCovariance rule);
    PathCovariance operator()(const PathRecord& record, LightPart part = LightPart::all) const;

  private:
    /// Without light that carries less than `least` of the path's luminance. `kept`: the luminance
    /// of the light that was followed.
    PathCovariance follow(const PathRecord& record, LightPart part, double least,
                          double& kept) const;
    /// Travel, past the occluders on the way where `share`, this light's part of the path's
    /// luminance, is large enough to be seen and the end's features can be.
    LightField to_surface(const LightField& field, const OccluderQuery::Segment& segment,
                          const Visibility& end, double share,
                          const OwnOutline* own = nullptr) const;
    LightField to_camera(const LightField& field, const OccluderQuery::Segment& segment,
                         const SensorGeometry& camera, double share,
                         const OwnOutline* own = nullptr) const;

    const RenderScene& scene_;
    Occluders occluders_;
    BrdfCovariance rule_;
    double smallest_;  // extent that stands for a point, scene units
    Vec3 center_;      // bounding sphere of the scene: light from infinity enters there
    float radius_;
};

}  // namespace covtrace
