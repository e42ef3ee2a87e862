/// A lamp that somebody adds to a scene, to see what the scene's own lights don't reach.
#pragma once

#include <optional>

#include "core/vec.h"

namespace covtrace {

/// It shines alike in all directions, and the camera does not see it. Place and power may be left
/// to the renderer.
struct LampDescription {
    std::optional<Vec3> at;  ///< world space; none: at the camera, beyond all backs that it passes
    float radius = 0;        ///< of a sphere, with a place only; 0: a point
    Rgb colour{1};           ///< of which the luminance does not count
    /// As that of PointLight; none: so that the camera sees what the lamp lights.
    std::optional<float> power;
    int area_light = -1;  ///< index of the sphere's emission, which has no power yet
    /// Whether it stands only where the light of `complete` does not reach what the camera sees.
    bool is_for_the_dark = false;
};

}  // namespace covtrace
