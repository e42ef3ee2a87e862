/// Stand-ins for a camera or lights that a scene's file does not have.
#pragma once

#include "scene/scene_description.h"

namespace covtrace {

/// Completes a scene whose file has no light at all, unless another one took its place: a grey sky,
/// brightest at the horizon, and a key light of ten degrees from the upper left behind the camera,
/// so that a white surface that faces the key has about the value 1 in the image. They are to be
/// let in where walls keep them out (is_lit_from_outside); a lamp at the camera is for what they
/// still do not reach, but in frames of an animation and where the camera is in a medium. Adds the
/// warnings `no_camera`, with the place of a camera of `frame_all`, and `no_lights` to the others,
/// and one where there is nothing to be seen. Does nothing to a scene that is complete.
void complete(SceneDescription& scene);

/// Adds the sky and the key light of `complete`. `where`: the place that they are told to be from.
void add_default_lights(SceneDescription& scene, const SourceLocation& where);

}  // namespace covtrace
