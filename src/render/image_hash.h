/// A hash of the contents of a scene's image files.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scene/scene_description.h"

namespace covtrace {

/// The image files of all textures and lights, every file once, in the order of the names. An image
/// that lies within a scene's file is not listed: the hash of that file covers it.
std::vector<std::filesystem::path> image_files(const SceneDescription& scene);

/// Hash of the contents of all textures' and lights' image files, read in parallel: 16 hexadecimal
/// digits. The content hash of the description covers embedded images alone. Throws Error(scene)
/// where a file can't be read.
std::string image_hash(const SceneDescription& scene);

}  // namespace covtrace
