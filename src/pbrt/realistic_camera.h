/// pbrt's "realistic" camera.
#pragma once

#include "pbrt/build_context.h"

namespace covtrace {

/// Gives the scene's camera the lens of a file, and the numbers of the thin lens that stands for
/// it. Where the file is missing a thin lens of 50 mm takes its place, with a warning. The film
/// must have been read before. Throws Error(scene) for a lens or a focus that can't be.
void build_realistic_camera(Entity& camera, Entity& film, BuildContext& context);

}  // namespace covtrace
