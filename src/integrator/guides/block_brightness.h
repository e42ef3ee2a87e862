/// Brightness of an image by blocks, as few paths tell it: what the noise of a place is compared
/// with, so that dark parts count as much as bright ones.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/vec.h"

namespace covtrace {

class BlockBrightness {
  public:
    /// The block at a place of the image, both coordinates in [0, 1).
    static uint16_t block(Vec2 place) {
        const auto along = [](float v) { return std::min(int(v * kBlocks), kBlocks - 1); };
        return static_cast<uint16_t>(along(place.y) * kBlocks + along(place.x));
    }

    /// Adds the luminance of a path.
    void add(uint16_t block, float light) {
        sums_[block] += double(light);
        counts_[block] += 1;
        sum_ += double(light);
        ++count_;
    }
    /// Whether no path has found any light.
    bool is_black() const { return !(sum_ > 0); }
    /// Mean luminance of a block's paths and of two that are as bright as the image, which keep few
    /// paths from telling too much.
    double around(uint16_t block) const {
        return (sums_[block] + 2 * sum_ / double(count_)) / (counts_[block] + 2);
    }

  private:
    static constexpr int kBlocks = 12;  ///< along each side
    std::vector<double> sums_ = std::vector<double>(kBlocks * kBlocks);
    std::vector<double> counts_ = std::vector<double>(kBlocks * kBlocks);
    double sum_ = 0;
    int64_t count_ = 0;
};

}  // namespace covtrace
