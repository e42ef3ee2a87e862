/// Private to this folder: the tangents of vertices (TANGENT).
#pragma once

#include <string>

#include "gltf/document.h"
#include "scene/scene_description.h"

namespace covtrace::gltf {

/// Sets the tangents of a mesh, whose triangles, texture coordinates and normals are known, from an
/// accessor of four numbers each: the tangent, and the sign w of the y of normal maps, which is
/// along w (normal x tangent). Refuses another number of tangents than of positions.
void read_tangents(const Document& document, int accessor, TriangleMesh& mesh,
                   const std::string& place);

}  // namespace covtrace::gltf
