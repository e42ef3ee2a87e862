/// Private to this folder: factors from glTF's units to those of scenes.
#pragma once

#include "core/vec.h"

namespace covtrace::gltf {

inline constexpr float kDegrees = 180 / kPi;  ///< of a radian
inline constexpr float kLumensPerWatt = 683;  ///< of monochromatic light at 555 nm

}  // namespace covtrace::gltf
