/// Where the picture ends on the film itself: beside a fisheye's circle, or that of a traced lens.
#pragma once

#include <optional>

#include "camera/camera.h"

namespace covtrace {

/// The rim of the part of a film that light gets to, which is convex. It is an edge in the picture
/// that no outline in the scene tells of.
class FilmRim {
  public:
    /// How far rims are looked for, pixels: as far as occluders' edges that filters must keep to
    /// (frequency/occlusion.cpp, kDistance).
    static constexpr float kReach = 8;

    /// The rim in the region from `low` to `high`, in pixels.
    FilmRim(const Camera& camera, Vec2 low, Vec2 high);

    /// Whether the picture ends anywhere near the region.
    bool is_there() const { return is_there_; }
    /// The way from a place that light gets to to the nearest point of the rim, in pixels right and
    /// down; none where it is farther than kReach, and from places that see nothing.
    std::optional<Vec2> way(Vec2 film) const;

  private:
    bool sees(Vec2 film) const;
    /// Whether light gets to a square around a place, and so to the circle of kReach in it.
    bool holds_square(Vec2 film) const;

    const Camera& camera_;
    bool is_there_ = false;
};

}  // namespace covtrace
