/// Panes: surfaces that light goes through without being scattered, as windows and bulbs have them.
#pragma once

#include "scene/scene_description.h"

namespace covtrace {

/// Whether every way through the shape's surface is known from the direction alone: smooth clear
/// dielectrics, whole or as thin panes, whose index is the same for all wavelengths. None are those
/// that shine, have alpha, mixes, bump or normal maps, or are made rougher behind other lobes.
bool is_pane(const SceneDescription& scene, const ShapeDescription& shape);

}  // namespace covtrace
