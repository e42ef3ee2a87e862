/// One function per material type of pbrt-v4: parameters to a model that covtrace renders.
#pragma once

#include "scene/build_context.h"

namespace covtrace {

class TextureBuilder;

/// Types that are not rendered are replaced by the nearest one, with a warning.
/// Errors: Error(scene) for types that pbrt-v4 doesn't have and for values out of range.
decltype(MaterialDescription::value) material_model(Entity& entity, TextureBuilder& textures,
                                                    BuildContext& context);

}  // namespace covtrace
