/// The direction that is up in a scene.
#pragma once

#include "scene/scene_description.h"

namespace covtrace {

/// The axis of the world (with its sign) that is nearest to a direction.
Vec3 nearest_axis(Vec3 direction);

/// The description's `up`, or else the axis that is nearest to where the top of the picture points.
Vec3 up_axis(const SceneDescription& scene);

/// From light space, whose pole is z and in which a lat-long picture's middle is -x and its right
/// half begins at -y, to the world: the pole is up, and the middle lies along +x (+z where that is
/// up).
Transform upright_light(const SceneDescription& scene);

}  // namespace covtrace
