/// A guide of paths to where light comes from.
///
/// A place in a room gets most of its light from few directions: a floor in the sun, a wall beside
/// a lamp, a door that stands ajar. The guide learns them once per scene, before anything is
/// rendered, from paths of the camera (Müller et al. 2017, "Practical path guiding for efficient
/// light-transport simulation"), and follows the root of the mean square of what they bring (Rath
/// et al. 2020, "Variance-aware path guiding"). What a direction brings is not one path's estimate
/// of it, but the mean of many paths that met surfaces around the place where it ends
/// (`RadianceCache`): so few paths suffice. BSDF and guide share the samples, so that estimates
/// stay unbiased whatever it holds. Where it would not pay, it is dropped after a short trial.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/frame.h"
#include "integrator/guides/direction_histogram.h"
#include "integrator/guides/guide_outcome.h"
#include "integrator/guides/path_lesson.h"
#include "integrator/guides/place_tree.h"

namespace covtrace {

struct LitScene;
class CausticGuide;
class LampGuide;
class SkyGuide;

/// Directions that light comes from, over the hemisphere around a mean normal.
struct PathGuideCell {
    Frame frame;
    float share = 0;                ///< share of the samples that follow the guide
    DirectionHistogram directions;  ///< relative to the cosine's density
};

class PathGuide {
  public:
    /// Makes an empty guide.
    PathGuide() = default;
    /// Learns from a scene, by paths led by the other guides. The result is deterministic; it is
    /// empty where a guide would not pay.
    PathGuide(const LitScene& scene, const CausticGuide& caustics, const SkyGuide& sky,
              const LampGuide& lamps);

    bool is_empty() const { return cells_.empty(); }
    /// The directions that light comes from at a place; null where the BSDF is to choose alone.
    const PathGuideCell* at(const PlaceTree::Place& place) const {
        if (is_empty()) return nullptr;
        const PathGuideCell& cell = cells_[tree_.leaf(place.position, place.normal)];
        return cell.share > 0 ? &cell : nullptr;
    }
    Vec3 sample(const PathGuideCell& cell, Vec2 u) const;
    /// Density of `sample`, per solid angle.
    float pdf(const PathGuideCell& cell, Vec3 w) const;
    const GuideOutcome& outcome() const { return outcome_; }

    /// Learns from what paths tell; returns the share of the noise that is left, as far as those
    /// paths know.
    double learn(const PathLesson& lesson);

  private:
    PlaceTree tree_;
    std::vector<PathGuideCell> cells_;
    GuideOutcome outcome_;
};

}  // namespace covtrace
