/// What the image files of a scene hold, as one number.
#pragma once

#include <string>

#include "scene/scene_description.h"

namespace covtrace {

/// Hash of the contents of all textures' and lights' image files, read in parallel: 16 hexadecimal
/// digits. The content hash of the description does not know them, but those that are embedded.
/// Throws Error(scene) where a file can't be read.
std::string image_hash(const SceneDescription& scene);

}  // namespace covtrace
