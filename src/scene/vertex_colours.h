/// Colours of a mesh's vertices: where they jump from one triangle to the next.
#pragma once

#include "scene/scene_description.h"

namespace covtrace {

/// Fills `colour_steps` of a mesh that has colours. Triangles are neighbours where two corners have
/// the same positions, as files split vertices to give each face a colour of its own.
void find_colour_steps(TriangleMesh& mesh);

}  // namespace covtrace
