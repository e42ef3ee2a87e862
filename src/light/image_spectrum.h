/// How fast the image of a goniometric or a projection light varies with the direction.
#pragma once

#include "core/frame.h"
#include "light/image.h"
#include "texture/image_spectrum.h"

namespace covtrace {

class LightImageSpectrum {
  public:
    /// Measures the image, and for a slide its borders against the dark; the image must outlive the
    /// spectrum.
    explicit LightImageSpectrum(const LightImage& image);

    /// Second moments of the angular amplitude spectrum around the world direction `frame.z`, which
    /// points away from the light, in the frame's x and y, (cycles per radian)^2. Zero beside a
    /// slide.
    SpatialCovariance2 at(const Frame& frame) const;

  private:
    /// Derivative of the image's place by a rotation of w towards the unit vector `axis`, per
    /// radian.
    Vec2 place_per_radian(Vec3 w, Vec3 axis) const;

    const LightImage* image_;
    ImageSpectrum spectrum_;
    /// Black margin around the image as `spectrum_` has measured it, in parts of the image.
    Vec2 margin_;
};

}  // namespace covtrace
