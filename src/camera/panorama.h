/// Cameras that see by a map of directions: panoramas and fisheyes.
#pragma once

#include "scene/scene_description.h"

namespace covtrace {

/// The map between a film and directions in camera space. A fisheye looks along z; its circle has
/// the radius 1 on the window of CameraDescription, centre at 0, and is seen under the whole `fov`:
/// the angle to the axis is in proportion to the radius (equidistant), or the solid angle is to the
/// circle's area (equisolid).
class Panorama {
  public:
    /// A film of `width` x `height` pixels, whose place (0, 0) lies at `origin` on the window and
    /// whose pixels are as far from each other as `per_pixel`.
    Panorama(const CameraDescription& description, int width, int height, Vec2 origin,
             Vec2 per_pixel);

    /// The unit direction of a place on the film in pixels, y down; those a little beyond the
    /// film's edges have one, too.
    Vec3 direction(Vec2 film) const;
    /// The place of a direction, of length 1.
    Vec2 film(Vec3 direction) const;
    /// Whether light gets to a place: within a fisheye's circle.
    bool sees(Vec2 film) const;
    /// Angle of a pixel, radians, where the map is not stretched.
    float pixel_angle() const;

  private:
    bool is_fisheye() const;
    /// A fisheye's angle to the axis at a radius on the window, and the other way round.
    float angle(float radius) const;
    float radius(float angle) const;

    CameraDescription::Mapping mapping_;
    std::array<float, 4> sphere_part_;
    float half_fov_;  // radians
    Vec2 size_, origin_, per_pixel_;
};

}  // namespace covtrace
