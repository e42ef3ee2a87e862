/// Reading scene files of all formats that are known.
#pragma once

#include <filesystem>
#include <string>

#include "scene/read_options.h"
#include "scene/scene_description.h"

namespace covtrace {

/// Whether a file has the name of a scene: .pbrt, .pbrt.gz, .gltf, .glb, and those of formats that
/// other programs read (.blend, .usd, .xml …), for which read_scene_file says what to do.
bool is_scene_file(const std::filesystem::path& file);

/// Reads a scene: glTF 2.0 where the name ends in .gltf or .glb, pbrt-v4 otherwise. Throws as both
/// readers do, and Error(scene) for formats that are known but not read.
SceneDescription read_scene_file(const std::filesystem::path& file,
                                 const ReadOptions& options = {});

/// Reads a scene from memory, whose format its first bytes say: binary glTF, JSON as glTF, or else
/// pbrt-v4. Its name is "scene", messages call it `name`, and the files that it names are looked
/// for from the working folder on. Throws as read_scene_file.
SceneDescription read_scene_bytes(const std::string& bytes, const std::string& name,
                                  const ReadOptions& options = {});

}  // namespace covtrace
