/// Private to this folder: points and lines as solids of about a pixel's width.
#pragma once

#include <string>
#include <vector>

#include "gltf/document.h"
#include "gltf/nodes.h"
#include "scene/scene_description.h"

namespace covtrace::gltf {

/// Whether a primitive is made of points or lines; its mode must be one of the format's.
bool has_marks(const tinygltf::Primitive& primitive);

/// The warning of a primitive of points or lines: how it is shown, and whether light falls on it.
std::string told_of_marks(const tinygltf::Primitive& primitive);

/// The radius of points and lines of each mesh, in its own units: half a thousandth of the diagonal
/// of a box around all that is placed, about half a pixel where the view holds all of it. Where
/// several nodes place a mesh their first says its scale. Empty where no placed mesh has any.
std::vector<float> mark_radii(const Document& document, const PlacedNodes& placed);

/// Turns the vertices of `mesh`, which has no triangles yet, to solids: tetrahedra at the points,
/// rods along the lines that `indices` name by `mode`. Returns the vertex that each of the new ones
/// comes from.
std::vector<uint32_t> make_solid(TriangleMesh& mesh, const std::vector<uint32_t>& indices, int mode,
                                 float radius);

}  // namespace covtrace::gltf
