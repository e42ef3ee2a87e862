/// The range of numbers that a network for images works in.
#pragma once

#include "reconstruction/half_buffer.h"

namespace covtrace {

/// A map from the values of an image to those that the network gets, and back. NaN counts as 0.
class InputRange {
  public:
    /// Makes the map for features: only values outside of [-1, 1] are changed.
    InputRange() = default;
    /// Makes the map for light: bright pixels become about 1, by a power of two, which changes no
    /// other bits, and none gets more than 10^4 times as bright as 99 of 100 pixels that have
    /// light. A single brighter pixel would otherwise decide on the exposure of the whole image,
    /// and spread over all that is near it.
    explicit InputRange(const ColorPlanes& light);

    /// Whether no value of the image is above 0.
    bool is_dark() const { return is_dark_; }
    float to_network(float value) const;
    float from_network(float value) const;

  private:
    bool is_dark_ = false;
    int exponent_ = 0;
    float least_ = -1, most_ = 1;
};

}  // namespace covtrace
