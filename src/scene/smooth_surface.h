/// Surfaces without any change from place to place: those whose geometry alone says where light
/// goes.
#pragma once

#include "scene/scene_description.h"

namespace covtrace {

/// Whether a texture is 0 everywhere; none is.
bool is_zero(const SceneDescription& scene, TextureId texture);

/// Whether nothing but its one material makes the shape's light: it does not shine, and has no
/// alpha, mix, layers, bump or normal map, and no lobes that are made rougher behind others.
bool is_plain(const SceneDescription& scene, const ShapeDescription& shape);

}  // namespace covtrace
