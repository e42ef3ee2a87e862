/// Lamps that were added to a scene, where the renderer puts them and how bright they are.
#pragma once

#include "geometry/geometry.h"
#include "scene/scene_description.h"
#include "texture/texture.h"

namespace covtrace {

/// Makes lights of the scene's lamps, and returns the scene. Those at the camera stand at its eye
/// or, where the middle of its view passes the backs of surfaces that it does not see, behind the
/// last of them. Where the power is left open, white surfaces are at most 0.6 times as bright as
/// white in three quarters of what is seen, in the lamp's light that comes straight, and 1.2 times
/// with what comes by way of other surfaces (as Lambertian ones, up to the scene's depth). Of
/// several such lamps each would reach that by itself and has its share of that power, one over
/// their number: together they may reach more or less. A warning tells the power. Rays pass where
/// alpha of the geometry, which is to be set, lets them. Deterministic.
const SceneDescription& stand_lamps(SceneDescription& scene, const Geometry& geometry,
                                    const TextureStore& textures);

}  // namespace covtrace
