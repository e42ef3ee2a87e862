#include "integrator/guides/radiance_cache.h"

namespace covtrace {

namespace {

constexpr size_t kCellPlaces = 32;  // most places of a cell

}  // namespace

RadianceCache::RadianceCache(std::span<const PlaceTree::Place> places)
    : tree_(places, kCellPlaces, order_, parts_), cells_(parts_.size()) {}

void RadianceCache::learn(std::span<const float> light) {
    for (size_t k = 0; k < parts_.size(); ++k) {
        double sum = 0;
        for (uint32_t i : parts_[k]) sum += double(light[i]);
        if (!parts_[k].empty()) cells_[k] = static_cast<float>(sum / double(parts_[k].size()));
    }
}

}  // namespace covtrace
