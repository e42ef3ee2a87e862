/// A guide to the parts of the sky that are to be seen from a place.
///
/// In a room nearly all samples of the sky end at the walls: the image that they are drawn from
/// knows nothing of the windows. The guide is learnt once per scene, before anything is rendered,
/// by rays to the sky from places that camera paths meet. It is mixed with the lights' own
/// sampling, so that estimates stay unbiased whatever it holds. Where most of the sky is to be
/// seen, it is dropped after a short trial.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/vec.h"
#include "integrator/guides/guide_outcome.h"
#include "integrator/guides/place_tree.h"
#include "light/sky_cell.h"

namespace covtrace {

struct LitScene;

/// Light of the sky that reaches a place.
struct SkySight {
    PlaceTree::Place place;
    Vec3 direction;   ///< unit, towards the sky
    float light = 0;  ///< luminance of its irradiance per solid angle
    /// Densities: of the directions that were tried, of the lights' own sampling, and of that by
    /// the guide so far alone, 0 where there was none.
    float tried_pdf = 0, lights_pdf = 0, guide_pdf = 0;
};

class SkyGuide {
  public:
    /// Makes an empty guide.
    SkyGuide() = default;
    /// Learns from a scene. The result is deterministic; it is empty where a guide would not pay.
    explicit SkyGuide(const LitScene& scene);

    bool is_empty() const { return tree_.is_empty(); }
    /// The sky as it is seen from a place with the unit normal `n` on the lit side; null where
    /// it is not known or needs no guide.
    const SkyCell* at(Vec3 position, Vec3 n) const {
        if (is_empty()) return nullptr;
        const SkyCell& cell = cells_[tree_.leaf(position, n)];
        return cell.share > 0 ? &cell : nullptr;
    }
    /// The outcome, with the bytes that it holds.
    const GuideOutcome& outcome() const { return outcome_; }

  private:
    /// Learns anew from sights, with shares by those among them that know the density of a guide.
    void learn(std::span<const SkySight> sights);

    PlaceTree tree_;
    std::vector<SkyCell> cells_;
    GuideOutcome outcome_;
};

/// Traces `count` camera paths, the first of them number `first`, tries `trials` directions at
/// every surface where they scatter, a part of them by `guide`, and returns those that reach the
/// sky. The result is deterministic.
std::vector<SkySight> look_for_sky(const LitScene& scene, const SkyGuide& guide, int64_t first,
                                   int64_t count, int trials);

}  // namespace covtrace
