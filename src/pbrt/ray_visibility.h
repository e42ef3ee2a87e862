/// The parameter "hiddenfrom" of shapes, skies and suns, which pbrt-v4 does not have.
#pragma once

#include "pbrt/build_context.h"
#include "scene/ray_kind.h"

namespace covtrace {

/// The rays that see something: all but the kinds that "string hiddenfrom" lists. Errors:
/// Error(scene) for unknown kinds.
RayKinds visible_to(Entity& entity);

}  // namespace covtrace
