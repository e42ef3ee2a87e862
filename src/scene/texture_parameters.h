/// Image textures and mappings out of the parameters of a Texture directive.
#pragma once

#include "scene/build_context.h"

namespace covtrace {

/// Errors: Error(scene) for unknown mappings.
TextureMapping texture_mapping(ParameterList& p, const SourceLocation& where,
                               const Transform& texture_from_world);
/// Errors: Error(scene) for missing files and unknown wrap modes, filters and encodings.
ImageTexture image_texture(ParameterList& p, const SourceLocation& where,
                           const Transform& texture_from_world, BuildContext& context);

}  // namespace covtrace
