/// Mirrors: surfaces that reflect light without scattering it, as polished metal and glass do.
#pragma once

#include "scene/scene_description.h"

namespace covtrace {

/// Whether the shape reflects light by a perfect mirror alone: smooth metal, or a pane (pane.h),
/// which reflects a little. None are those that shine, have alpha, mixes, layers, bump or normal
/// maps, or are made rougher behind other lobes.
bool is_mirror(const SceneDescription& scene, const ShapeDescription& shape);

}  // namespace covtrace
