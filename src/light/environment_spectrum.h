/// How fast the radiance of an infinite light varies with the direction.
#pragma once

#include <optional>

#include "core/frame.h"
#include "light/environment.h"
#include "texture/image_spectrum.h"

namespace covtrace {

/// Second moments of the angular amplitude spectrum, (cycles per radian)^2, in the x and y of
/// `tangent`, whose z is the direction that the light travels in.
struct AngularCovariance {
    Frame tangent;
    float a11 = 0, a12 = 0, a22 = 0;
};

class EnvironmentSpectrum {
  public:
    /// Measures the light's image, if it has one; the light must outlive the spectrum.
    explicit EnvironmentSpectrum(const Environment& light);

    /// The covariance around the world direction `w` (unit, away from the scene).
    AngularCovariance at(Vec3 w) const;
    /// Whether the light has an image or is a disc; else the spectrum is zero everywhere.
    bool varies() const { return image_.has_value() || light_->disc(); }

  private:
    const Environment* light_;
    std::optional<ImageSpectrum> image_;
    /// Least sine of the polar angle that the scale along a row is taken with.
    float pole_sine_ = 1;
    bool is_mirrored_ = false;  ///< whether light space is a mirror image of the world's
};

}  // namespace covtrace
