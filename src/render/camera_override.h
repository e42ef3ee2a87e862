/// A camera in place of the scene's own.
#pragma once

#include "render/overrides.h"

namespace covtrace {

/// Replaces the scene's camera by a perspective pinhole that rests. Of the scene's own it keeps the
/// shutter, whether it shows a mirror image of the world (as scenes in right-handed coordinates ask
/// of pbrt), and the medium around it, which mostly fills the scene; the film stays. The focus lies
/// on the target, for those who open the lens. Throws Error(usage) where the camera looks along its
/// up vector, or at itself.
void override_camera(const CameraOverride& camera, SceneDescription& scene);

}  // namespace covtrace
