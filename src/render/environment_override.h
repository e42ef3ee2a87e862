/// Light from all around in place of the scene's own.
#pragma once

#include "render/overrides.h"

namespace covtrace {

/// Replaces all infinite lights by one, or by none that is black. An image stands where the scene's
/// own environment image does; where there is none, its pole is up, its middle lies along +x (+z
/// where that is up), and it is no mirror image for the scene's camera. It may be let into rooms of
/// files without lights (SceneDescription::is_lit_from_outside).
void replace_environment(const EnvironmentOverride& environment, SceneDescription& scene);

/// Turns and scales the infinite lights, the scene's own or those that took their place, and tells
/// the scene of all overrides of them. Throws Error(usage) where there are none.
void change_environment(const SceneOverrides& overrides, SceneDescription& scene);

}  // namespace covtrace
