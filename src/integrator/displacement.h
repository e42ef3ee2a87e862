/// True displacement: meshes whose vertices move along their normals, as pbrt-v4 does it.
#pragma once

#include "scene/scene_description.h"
#include "texture/texture.h"

namespace covtrace {

/// Splits the triangles of all shapes that ask for it until their edges are short enough, moves
/// their vertices by the texture's heights, and gives them the normals of the new surface. Returns
/// the description. Throws Error(limit) where that makes more triangles than can be rendered,
/// Error(scene) for heights that are not finite.
SceneDescription& displace(SceneDescription& scene, const TextureStore& textures);

}  // namespace covtrace
