/// Meshes that are turned inside out.
#pragma once

#include "scene/scene_description.h"

namespace covtrace {

/// Whether a mesh is closed, or nearly, and its fronts are towards what it encloses.
bool is_inside_out(const TriangleMesh& mesh);

}  // namespace covtrace
