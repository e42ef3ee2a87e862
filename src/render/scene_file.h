/// Scene files of all formats that are known.
#pragma once

#include <filesystem>

#include "scene/read_scene.h"

namespace covtrace {

/// True for the names of scenes: .pbrt, .pbrt.gz, .gltf, .glb.
bool is_scene_file(const std::filesystem::path& file);

/// glTF 2.0 where the name ends in .gltf or .glb, pbrt-v4 otherwise. Errors: as both readers.
SceneDescription read_scene_file(const std::filesystem::path& file,
                                 const ReadOptions& options = {});

}  // namespace covtrace
