/// The layers of a material at a place, over whatever surface it has: a sheen under a clear coat.
#pragma once

#include "bsdf/bsdf.h"
#include "scene/scene_description.h"
#include "shading/material.h"
#include "texture/texture.h"

namespace covtrace {

/// Whether the material's surface is one that layers may lie on, and has any.
bool has_layers(const MaterialDescription& material);

/// Puts a surface under the material's layers, where it has any and may be under some.
void put_under_layers(Bsdf& bsdf, const MaterialDescription& material, const TextureStore& textures,
                      const TexturePoint& at, const MaterialTables& tables);

/// Share of the light of an emitting surface that gets through the layers above it; see
/// layer_transmission.
Rgb emission_share(const MaterialDescription& material, const TextureStore& textures,
                   const TexturePoint& at, const MaterialTables& tables, float cosine);

}  // namespace covtrace
