/// The scene that a command is given: a file, or standard input.
#pragma once

#include <string>

#include "scene/read_options.h"
#include "scene/scene_description.h"

namespace covtrace::cli {

/// The name of standard input in the place of a scene's file.
inline constexpr const char* kStandardInput = "-";

/// Reads a scene's file, or all of standard input for "-". Throws as read_scene_file, and Error(io)
/// where standard input cannot be read.
SceneDescription read_scene(const std::string& scene, const ReadOptions& options = {});

}  // namespace covtrace::cli
