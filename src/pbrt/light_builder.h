/// Makes lights of the directives LightSource and AreaLightSource.
#pragma once

#include "pbrt/build_context.h"

namespace covtrace {

/// Builds a light, whose radiance or intensity includes every scale and power of the file. Errors:
/// Error(scene) for unknown types, values out of range and missing images.
LightDescription build_light(Entity& entity, const Transform& light_to_world,
                             BuildContext& context);
AreaLightDescription build_area_light(Entity& entity, BuildContext& context);

}  // namespace covtrace
