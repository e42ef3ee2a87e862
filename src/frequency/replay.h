/// Replay: from a recorded path to its covariance at the sensor, the only place that knows both
/// sides.
#pragma once

#include "covariance/covariance.hpp"
#include "frequency/brdf_covariance.h"
#include "frequency/light_source.h"
#include "frequency/occlusion.h"
#include "frequency/scene_spectra.h"
#include "integrator/lit_scene.h"
#include "integrator/path_record.h"

namespace covtrace {

/// Covariance of a path over (pixel x, pixel y, lens, lens, shutter) and its weight, the luminance
/// of all light that the record holds. Weight 0: no light, or a matrix that is not finite.
struct PathCovariance {
    covariance::SymmetricMatrix5<double> sigma;
    double weight = 0;
};

/// Part of a path's light that is followed. Emitters in view (PathVertex::in_view) and the light
/// that they shed on surfaces have spectra, and contrasts, of their own.
enum class LightPart { all, in_view, scattered };

/// Share of a path's luminance below which light is carried without a look at its occluders, the
/// dearest step of the replay: the contrast of its shadow edges is below that which the spectra of
/// textures count as visible.
inline constexpr double kSmallestShare = 0.1;

/// Data that the replays of all paths of a scene share.
struct ReplayedScene {
    const LitScene& scene;
    const SceneSpectra& spectra;
    Occluders occluders;
    BrdfCovariance rule;
    Vec3 center;      ///< bounding sphere of the scene: light from infinity enters there
    float radius;     ///< scene units
    double smallest;  ///< extent that stands for a point, scene units

    ReplayedScene(const LitScene& lit_scene, const SceneSpectra& scene_spectra,
                  const Occluders& scene_occluders, BrdfCovariance brdf_rule);
    /// The point where light from infinity, seen from p in the direction w, enters the bounding
    /// sphere.
    Vec3 entry(Vec3 p, Vec3 w) const;
};

/// Replays paths: walks each once from its far end to the sensor. At every vertex the light found
/// there (its own emission, a sampled light) and the light that arrives from further on are merged
/// by luminance (an incoherent sum, covariance::merge), so that k vertices cost k steps.
class PathReplay {
  public:
    /// Prepares replays of paths in a scene; scene, spectra and occluders must outlive this object.
    PathReplay(const LitScene& scene, const SceneSpectra& spectra, const Occluders& occluders,
               BrdfCovariance rule)
        : context_(scene, spectra, occluders, rule) {}
    PathCovariance operator()(const PathRecord& record, LightPart part = LightPart::all) const;

  private:
    ReplayedScene context_;
};

}  // namespace covtrace
