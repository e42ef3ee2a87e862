/// Reads pbrt-v4 scene files (pbrt.org/fileformat-v4) into a SceneDescription.
///
/// Features of pbrt-v4 that covtrace doesn't render become warnings, which name them and what takes
/// their place; anything that pbrt-v4 doesn't have either is an error.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "scene/read_options.h"
#include "scene/scene_description.h"

namespace covtrace {

/// Reads a scene and every file it includes; meshes too, but no images. Without lights it is left
/// to `complete` (scene/defaults.h). Errors: Error(scene) as `file:line:column: what is wrong; what
/// was expected`, Error(limit) where the scene is too large, Error(io) where reading fails in the
/// middle, Error(usage) for choices that only glTF files offer. No other exception leaves.
SceneDescription read_pbrt(const std::filesystem::path& file, const ReadOptions& options = {});

/// Reads a scene from memory; messages call the text `name`, and the files that it names are looked
/// for from `folder` on.
SceneDescription read_pbrt_string(std::string_view text, std::string name,
                                  const std::filesystem::path& folder = {},
                                  const ReadOptions& options = {});

}  // namespace covtrace
