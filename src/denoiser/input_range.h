/// The range of numbers that a network for images works in.
#pragma once

#include "reconstruction/half_buffer.h"

namespace covtrace {

/// Maps what an image has to what the network gets, and back. What is no number counts as 0.
class InputRange {
  public:
    /// Features: nothing but values outside of [-1, 1] is changed.
    InputRange() = default;
    /// Light: bright pixels become about 1, by a power of two, which changes no other bits, and
    /// none more than 10^4 times as bright as 99 of 100 pixels that have light. A single one that
    /// is would else decide on the exposure of the whole image, and spread over all that is near
    /// it.
    explicit InputRange(const ColorPlanes& light);

    /// Nothing of the image is above 0.
    bool is_dark() const { return is_dark_; }
    float to_network(float value) const;
    float from_network(float value) const;

  private:
    bool is_dark_ = false;
    int exponent_ = 0;
    float least_ = -1, most_ = 1;
};

}  // namespace covtrace
