/// The direction that is up in a scene.
#pragma once

#include "scene/scene_description.h"

namespace covtrace {

/// The axis of the world (with its sign) that is nearest to a direction.
Vec3 nearest_axis(Vec3 direction);

/// The description's `up`, or else the axis that is nearest to where the top of the picture points.
Vec3 up_axis(const SceneDescription& scene);

}  // namespace covtrace
