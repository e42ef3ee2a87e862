/// Reads glTF 2.0 scenes (.gltf with its files, or one .glb) into a SceneDescription.
///
/// World space is glTF's: metres, y up. Radiance is in the file's photometric unit, cd/m² (nit):
/// emissive 1 is a radiance of 1, a light of 1 candela gives 1 lux at a metre, unless the lights
/// are so strong that they must be physical: then both are divided by 683 lm/W (gltf/lights.h).
/// Features that the file asks for and covtrace doesn't render become warnings that say what takes
/// their place. docs/guide/gltf.md has the whole mapping.
#pragma once

#include <filesystem>
#include <string>

#include "scene/read_options.h"
#include "scene/scene_description.h"

namespace covtrace {

/// True for names that end in .gltf or .glb, in any case.
bool is_gltf(const std::filesystem::path& file);

/// Reads a scene. Nodes that animations move are placed where they are at both ends of
/// `options.shutter`, in seconds of the animations; at time 0 without it. Meshes are read, image
/// files are not. What the file has no camera or lights for is left to `complete`
/// (scene/defaults.h).
///
/// Errors: Error(scene) as `file:line:column: …` for text that is no JSON, and as `file: place in
/// the document: what is wrong; what was expected` for the rest; Error(limit) where the scene is
/// too large; Error(usage) for a camera, scene, animation or variant that the file has not. Files
/// are looked for in the scene's folder and the search paths, and nowhere else.
SceneDescription read_gltf(const std::filesystem::path& file, const ReadOptions& options = {});

/// Reads a scene from memory, text or binary; messages call it `name`, and its files are looked for
/// in `folder` and the search paths.
SceneDescription read_gltf_bytes(const std::string& bytes, const std::string& name,
                                 const std::filesystem::path& folder = {},
                                 const ReadOptions& options = {});

}  // namespace covtrace
