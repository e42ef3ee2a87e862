/// Scenes whose only lamps are surfaces that glow, in files that viewers light by themselves.
#pragma once

#include "geometry/geometry.h"
#include "scene/scene_description.h"
#include "texture/texture.h"

namespace covtrace {

/// Adds the stand-ins for light (`add_default_lights`) where the scene has a warning `glow_alone`
/// and what glows leaves most of what the camera sees dark, and gives the warning out. Rays pass
/// where alpha of the geometry, which is to be set, lets them. Deterministic.
void light_glow_alone(SceneDescription& scene, const Geometry& geometry,
                      const TextureStore& textures);

}  // namespace covtrace
