/// A scene in a few lines, for people.
#pragma once

#include <string>

#include "scene/scene_description.h"

namespace covtrace {

/// Camera, film, counts of shapes, triangles, materials, textures and lights, the content's hash,
/// and all warnings. Several lines.
std::string summarize(const SceneDescription& scene);

}  // namespace covtrace
