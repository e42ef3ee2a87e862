/// The light that an aperture stop lets through, point by point.
#pragma once

#include <vector>

#include "core/vec.h"
#include "scene/lens_description.h"

namespace covtrace {

class ApertureMask {
  public:
    /// The round one: 1 inside the unit circle.
    ApertureMask() = default;
    /// A shape, scaled so that it lets as much light through as the round one, as in pbrt. Throws
    /// Error(scene) for an image that can't be read or is black.
    explicit ApertureMask(const ApertureShape& shape);

    /// The share of the light that gets through, at a place in units of the stop's radius; 0
    /// outside of the square [-1, 1]^2.
    float operator()(Vec2 place) const;
    /// Radius of a circle that holds all that lets light through.
    float reach() const { return reach_; }

  private:
    int width_ = 0, height_ = 0;
    std::vector<float> texels_;  // row by row from y = -1; empty: round
    float reach_ = 1;
};

}  // namespace covtrace
