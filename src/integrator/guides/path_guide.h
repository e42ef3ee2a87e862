/// A guide of paths to where light comes from.
///
/// A place in a room gets most of its light from few directions: a floor in the sun, a wall beside
/// a lamp, a door that stands ajar. The guide learns them once per scene, before anything is
/// rendered, from paths of the camera (Müller et al. 2017, "Practical path guiding for efficient
/// light-transport simulation"), and follows the root of the mean square of what they bring (Rath
/// et al. 2020, "Variance-aware path guiding"). What a direction brings is not one path's estimate
/// of it, but the mean of many paths that met surfaces around the place where it ends
/// (`RadianceCache`): so few paths suffice. Small spots that much light comes from are balls that
/// all cells share (`BrightSpots`). BSDF and guide share the samples, so that estimates
/// stay unbiased whatever it holds. Where it would not pay, it is dropped after a short trial.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/frame.h"
#include "integrator/guides/bright_spots.h"
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
    float spot_share = 0;           ///< of these, the share that goes to spots
    DirectionHistogram directions;  ///< relative to the cosine's density
};

/// The guide of a place: the directions of its cell, and the spots as the place sees them.
class PathGuideMixture {
  public:
    /// Makes one that leads nowhere.
    PathGuideMixture() = default;
    PathGuideMixture(const PathGuideCell& cell, const BrightSpots::View& spots)
        : cell_(&cell), spots_(spots) {
        if (!spots.is_empty()) spot_share_ = cell.spot_share;
    }
    /// Share of the samples that follow the guide.
    float share() const { return cell_ ? cell_->share : 0; }
    /// A direction, of a choice and a place in [0, 1); not of one that leads nowhere.
    Vec3 sample(float choice, Vec2 u) const;
    /// Density of `sample`, per solid angle.
    float pdf(Vec3 w) const;

  private:
    const PathGuideCell* cell_ = nullptr;
    BrightSpots::View spots_;
    float spot_share_ = 0;
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
    /// The guide of a place; one that leads nowhere where the BSDF is to choose alone.
    PathGuideMixture at(const PlaceTree::Place& place) const {
        if (is_empty()) return {};
        const PathGuideCell& cell = cells_[tree_.leaf(place.position, place.normal)];
        if (!(cell.share > 0)) return {};
        return {cell, cell.spot_share > 0 ? spots_.seen_from(place.position, place.normal)
                                          : BrightSpots::View()};
    }
    const GuideOutcome& outcome() const { return outcome_; }

    /// Learns from what paths tell; returns the share of the noise that is left, as far as those
    /// paths know.
    double learn(const PathLesson& lesson);

  private:
    PlaceTree tree_;
    std::vector<PathGuideCell> cells_;
    BrightSpots spots_;
    GuideOutcome outcome_;
};

}  // namespace covtrace
