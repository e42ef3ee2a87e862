/// The mean light that leaves surfaces, by place: what many noisy paths tell together.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "integrator/guides/place_tree.h"

namespace covtrace {

class RadianceCache {
  public:
    /// Makes a cache that is dark everywhere, with small cells where places are dense.
    explicit RadianceCache(std::span<const PlaceTree::Place> places);

    /// Takes the means of what paths found at the places, in their order.
    void learn(std::span<const float> light);
    /// Luminance of the radiance that leaves a place towards those who look at it.
    float at(const PlaceTree::Place& place) const {
        return cells_[tree_.leaf(place.position, place.normal)];
    }

  private:
    std::vector<uint32_t> order_;  ///< the places, sorted by cell
    std::vector<PlaceTree::Part> parts_;
    PlaceTree tree_;  // behind what it fills
    std::vector<float> cells_;
};

}  // namespace covtrace
