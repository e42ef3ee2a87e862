/// One function per material type of pbrt-v4: parameters to a model that covtrace renders.
#pragma once

#include "pbrt/build_context.h"

namespace covtrace {

class TextureBuilder;

/// Makes the model of a material. Types that are not rendered are replaced by the nearest one, with
/// a warning. Errors: Error(scene) for types that pbrt-v4 doesn't have and for values out of range.
decltype(MaterialDescription::value) material_model(Entity& entity, TextureBuilder& textures,
                                                    BuildContext& context);

/// Textures that turn a material's normals, and how they lie (see MaterialDescription); -1 where
/// one isn't given.
struct NormalMaps {
    TextureId displacement = -1, normal_map = -1;
    bool follow_uv = false;   ///< a parameter of ours: "mapsfollowuv"
    float bump_strength = 1;  ///< a parameter of ours: "bumpstrength"
};
NormalMaps normal_maps(Entity& entity, TextureBuilder& textures, BuildContext& context);

/// Layers over a material, by parameters of ours.
struct MaterialLayers {
    std::optional<SheenLayer> sheen;
    std::optional<ClearcoatLayer> clearcoat;
};

/// The layers that a material's parameters ask for:
///
/// - fibres, of "sheen", a colour, and "sheenroughness", the width of their distribution;
/// - a clear coat, of "coat", its weight, "coatroughness", its GGX alpha, "coateta", its index, and
///   "coattint", the share of light that crosses it along its normal twice.
///
/// Errors: Error(scene) for an index that is not above 0.
MaterialLayers material_layers(Entity& entity, TextureBuilder& textures, BuildContext& context);

}  // namespace covtrace
