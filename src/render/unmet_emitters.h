/// Emitters in view that are so small that no path has met them: the error that samples of a pixel
/// cannot tell.
#pragma once

#include "core/plane.h"
#include "render/pass.h"

namespace covtrace {

/// Emitters that cover less of a pixel than few samples would be sure to meet, seen directly or
/// through specular surfaces. A lamp that covers the share c of a pixel with the radiance L adds
/// the mean L c and, to one sample, the second moment L^2 c. Both moments are estimated from one
/// path per pixel, in which every such lamp is as wide as the pixel and its light as much weaker,
/// so that few paths miss it. Curved mirrors, which make lamps smaller, are taken for flat ones.
class UnmetEmitters {
  public:
    /// Makes an object without any such emitters.
    UnmetEmitters() = default;
    /// Traces the paths; none where no emitter is small. The result is deterministic.
    UnmetEmitters(const PassContext& context, PixelBounds region);

    bool empty() const { return mean_.size() == 0; }
    /// Squared error of pixel i that is due to unmet emitters after `count` samples, which made an
    /// image of the luminance `brightness`, over brightness^2 + 0.01.
    float squared_error(size_t i, double count, float brightness) const;
    /// Variance of one sample that is due to unmet emitters, where `count` samples do not know it;
    /// 0 where they do.
    float variance(size_t i, double count) const;

  private:
    Plane mean_, square_;  ///< luminance of the emitters in one sample, and its square
};

}  // namespace covtrace
