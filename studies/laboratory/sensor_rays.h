/// Rays around one ray of the camera, by their offsets in the coordinates of the sensor's
/// covariance.
#pragma once

#include <array>

#include "integrator/render_scene.h"

namespace covtrace {

/// Offset in (pixel, pixel, lens, lens, shutter): pixels right and down, lens radii right and down,
/// and the shutter interval as the unit of time.
using SensorOffset = std::array<double, 5>;

class SensorRays {
  public:
    /// Rays around the central ray, which goes through `film` (pixels, y down), the centre of the
    /// lens, in the middle of the shutter interval. The scene must outlive this object.
    SensorRays(const RenderScene& scene, Vec2 film);
    /// The ray at an offset. Film positions may lie outside the frame; lens points outside the unit
    /// disc and times outside the shutter are taken as they are.
    Ray operator()(const SensorOffset& offset) const;
    Vec2 film() const { return film_; }

  private:
    const RenderScene& scene_;
    Vec2 film_;
};

/// The axes along which any two rays see different things: not the lens of a pinhole camera, not
/// the shutter where nothing moves.
std::array<bool, 5> sensor_axes(const RenderScene& scene);

}  // namespace covtrace
