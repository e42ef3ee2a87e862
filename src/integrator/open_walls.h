/// Rooms of files without lights, which light from outside does not reach.
#pragma once

#include "geometry/geometry.h"
#include "scene/scene_description.h"
#include "texture/texture.h"

namespace covtrace {

/// Lets light pass the outermost walls of a scene that is lit from outside (is_lit_from_outside)
/// where that brings it to what the camera sees, and the walls keep it off: of all rays the
/// camera's alone meet them, straight, in perfect mirrors and through clear glass. Adds a warning.
/// Returns whether it did: then `geometry`, of which alpha is to be set, is that of another scene
/// and has to be built again. Deterministic.
bool open_walls(SceneDescription& scene, const Geometry& geometry, const TextureStore& textures);

}  // namespace covtrace
