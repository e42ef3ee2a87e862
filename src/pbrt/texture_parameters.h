/// Makes image textures and mappings of the parameters of a Texture directive.
#pragma once

#include "pbrt/build_context.h"
#include "pbrt/current_transform.h"

namespace covtrace {

/// Reads a mapping. Errors: Error(scene) for unknown ones, and for those of a space that a matrix
/// flattens.
TextureMapping texture_mapping(ParameterList& p, const SourceLocation& where,
                               const CurrentTransform& texture_to_world);
/// Reads an image texture. Errors: Error(scene) for missing files and unknown wrap modes, filters
/// and encodings.
ImageTexture image_texture(ParameterList& p, const SourceLocation& where,
                           const CurrentTransform& texture_to_world, BuildContext& context);

}  // namespace covtrace
