/// Lamps beside the scene's own lights.
#pragma once

#include <vector>

#include "scene/scene_description.h"

namespace covtrace {

/// Adds lamps to the scene, and the spheres of those that have a radius. They take the place of the
/// lights that a scene without any would get (scene/defaults.h). Does nothing without lamps.
void add_lamps(const std::vector<LampDescription>& lamps, SceneDescription& scene);

}  // namespace covtrace
