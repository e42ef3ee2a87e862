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
    /// Derivative of LightImage::place by a rotation of w towards the unit vector `axis`, per
    /// radian.
    Vec2 place_per_radian(Vec3 w, Vec3 axis) const;

    const LightImage* image_;
    ImageSpectrum spectrum_;
    /// Width of the black margin on each side of the image that `spectrum_` has measured with it,
    /// as a share of the image's width and height; 0 for a goniometric light.
    Vec2 margin_;
};

}  // namespace covtrace
