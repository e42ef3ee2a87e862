/// Lamps beside the scene's own lights.
#pragma once

#include <string>
#include <vector>

#include "scene/scene_description.h"

namespace covtrace {

/// A lamp in the words in which options say it: "1,2,3 radius 0.1 colour 1,0.9,0.8 power 60".
std::string lamp_text(const LampDescription& lamp);

/// Adds lamps to the scene, and the spheres of those that have a radius. They take the place of the
/// lights that a scene without any would get (scene/defaults.h). Does nothing without lamps.
void add_lamps(const std::vector<LampDescription>& lamps, SceneDescription& scene);

}  // namespace covtrace
