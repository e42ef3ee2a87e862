/// The camera of a scene in words that `--camera` takes.
#pragma once

#include <string>

#include "scene/scene_description.h"

namespace covtrace {

/// The place and direction of the camera when the shutter opens: "eye x,y,z target x,y,z", with
/// four decimals of the distance between both, and of a perspective camera " fov N". The target
/// lies on the axis of view, as far away as the focus or, where that is beyond all shapes or behind
/// them, as the middle of their bounds. " up x,y,z" follows where the top of the picture points
/// elsewhere than the axis that `--camera` takes for up.
std::string view_text(const SceneDescription& scene);

}  // namespace covtrace
