/// A camera for scenes that have none.
#pragma once

#include <string>

#include "scene/scene_description.h"

namespace covtrace {

/// Points a perspective camera of 40 degrees, the shorter side's, at the shapes from the front (the
/// side of +z, or of -y where z is up), 30 degrees to the right and 20 above: as near as the shape
/// of the film allows with all of them in the middle of the picture and a margin around. What is up
/// is up_axis. The focus lies on the middle of their bounds. The camera is that of a right-handed
/// world. Returns false, and changes nothing, where the scene is too large for single precision.
[[nodiscard]] bool frame_all(SceneDescription& scene);

/// The camera that `frame_all` makes, in words that `--camera` takes; the scene's own stays. Empty
/// where there are no shapes, or `frame_all` makes none.
std::string view_of_all(SceneDescription& scene);

/// Whether the camera is one that a reader got from `frame_all`, and nobody has changed since.
bool is_framed(const SceneDescription& scene);

}  // namespace covtrace
