/// A guide to the lamps, lights of finite distance, that are to be seen from a place.
///
/// Lights are chosen by what they would bring if nothing were in the way. Where most lamps stand
/// behind walls nearly all samples are lost to them. What lamps truly bring is learnt once per
/// scene, before anything is rendered, at places that camera paths meet: as factors on the light
/// tree's importances, which still tell how light falls off within a cell. No factor is 0, so that
/// estimates stay unbiased whatever was learnt. Where the choice gains little by them they are
/// dropped after a short trial.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "integrator/guides/guide_outcome.h"
#include "integrator/guides/place_tree.h"
#include "light/tree.h"

namespace covtrace {

struct LitScene;

/// A lamp that was tried at a place: a point of it, and whether it was to be seen.
struct LampTrial {
    PlaceTree::Place place;
    int light = -1;
    float light_found = 0;  ///< luminance that the BSDF scatters of it; 0 where it is not seen
    /// Densities per solid angle: of the trial, of the point on the lamp alone, and of the BSDF;
    /// for delta lights without that of the point.
    float tried_pdf = 0, place_pdf = 0, bsdf_pdf = 0;
    /// A step of the way to the lamp in the light tree.
    struct Step {
        uint32_t child = 0;  ///< index of its factor
        float square = 0;    ///< of what was found by the child, over its importance
    };
    std::vector<Step> steps;
};

class LampGuide {
  public:
    /// Makes an empty guide.
    LampGuide() = default;
    /// Learns from a scene. The result is deterministic; it is empty where a guide would not pay.
    explicit LampGuide(const LitScene& scene);

    bool is_empty() const { return tree_.is_empty(); }
    /// Factors for a place with the unit normal `n` on the lit side; none where nothing was learnt.
    LightTree::Factors at(Vec3 position, Vec3 n) const {
        if (is_empty()) return {};
        return {factors_.data() + size_t(tree_.leaf(position, n)) * factor_count_, factor_count_};
    }
    const GuideOutcome& outcome() const { return outcome_; }

  private:
    void learn(std::span<const LampTrial> trials);
    /// Second moment of the light of lamps that BSDFs and lights find together, with the guide over
    /// that without it.
    double second_moment(const LitScene& scene, std::span<const LampTrial> trials) const;

    PlaceTree tree_;
    size_t factor_count_ = 0;     ///< factors of a cell
    std::vector<float> factors_;  ///< cell by cell
    GuideOutcome outcome_;
};

/// Traces `count` camera paths, the first of them number `first`, and tries `trials` lamps at every
/// surface where they scatter. The result is deterministic.
std::vector<LampTrial> try_lamps(const LitScene& scene, int64_t first, int64_t count, int trials);

}  // namespace covtrace
