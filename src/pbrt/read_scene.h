/// Reads pbrt-v4 scene files (pbrt.org/fileformat-v4) into a SceneDescription.
///
/// What pbrt-v4 has and covtrace doesn't render becomes a warning that names it and what takes its
/// place; what pbrt-v4 doesn't have either is an error.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "scene/read_options.h"
#include "scene/scene_description.h"

namespace covtrace {

/// Reads a scene and every file it includes; meshes too, but no images.
/// Errors: Error(scene) as `file:line:column: what is wrong; what was expected`, Error(limit) where
/// the scene is too large, Error(io) where reading fails in the middle. No other exception leaves.
SceneDescription read_pbrt(const std::filesystem::path& file, const ReadOptions& options = {});

/// The same from memory; `name` is what messages call the text, `folder` what it refers to.
SceneDescription read_pbrt_string(std::string_view text, std::string name,
                                  const std::filesystem::path& folder = {},
                                  const ReadOptions& options = {});

}  // namespace covtrace
