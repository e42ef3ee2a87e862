/// Private to this folder: KHR_lights_punctual, and default lights for a scene without any.
#pragma once

#include <span>
#include <vector>

#include "gltf/document.h"
#include "gltf/nodes.h"
#include "scene/scene_description.h"

namespace covtrace::gltf {

/// Appends the light of a placed node, if it has one: candela as radiant intensity, lux as
/// irradiance. Lights stand where they are at the start of the shutter.
void add_light(const Document& document, const PlacedNode& placed, SceneDescription& scene,
               WarningLog& log);

/// Brings lights in physical units to the scale of emission 1 = white. Viewers, and files made for
/// them, take candela and lux for the units of the picture; exporters of renderers (Blender's)
/// write 683 lm/W times what the renderer used. Lights that give the middle of the scene more than
/// kPhysicalLux together are taken to be of such exporters and divided by kLumensPerWatt, with a
/// warning; see docs/guide/gltf.md. `judged`: the lights that this is decided by, the scene's own
/// or, of a frame of an animation, those of several moments, of which the brightest counts.
void scale_lights(const Document& document, const Bounds3& bounds,
                  std::span<const std::vector<LightDescription>> judged, SceneDescription& scene,
                  WarningLog& log);
inline constexpr float kPhysicalLux = 100;

}  // namespace covtrace::gltf
