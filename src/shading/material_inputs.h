/// Inputs of a material's BSDF: whether any of them varies, and its colours.
#pragma once

#include <algorithm>

#include "scene/scene_description.h"
#include "shading/material.h"
#include "texture/texture.h"

namespace covtrace {

constexpr float kDefaultReflectance = 0.5f;  ///< where the scene gives none

/// A number as a share in [0, 1]. NaN becomes 0, so that a broken texel can't spread.
inline float share(float v) {
    return v > 0 ? std::min(v, 1.0f) : 0;
}
inline Rgb share(Rgb c) {
    return {share(c.r), share(c.g), share(c.b)};
}

/// A coefficient, which is not negative; NaN becomes 0.
inline float at_least_0(float v) {
    return v > 0 ? v : 0;
}
inline Rgb at_least_0(Rgb c) {
    return {at_least_0(c.r), at_least_0(c.g), at_least_0(c.b)};
}

/// Whether no texture of the material's model and layers varies.
bool is_constant(const MaterialDescription& m, const TextureStore& textures);
/// The colours of the material's model as the scene gives them; `fixed` where it gives none.
MaterialColours colours_of(const MaterialDescription& m);

}  // namespace covtrace
