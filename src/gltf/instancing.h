/// Private to this folder: copies of a node's mesh, by EXT_mesh_gpu_instancing.
#pragma once

#include <vector>

#include "core/transform.h"
#include "gltf/document.h"

namespace covtrace::gltf {

/// The matrices from the copies of the mesh of nodes[index] to the node's space; the identity alone
/// where the node has no mesh or no copies. Refuses attributes of different counts. Throws
/// Error(limit) where the copies of all nodes are more than the document's budget allows.
std::vector<Matrix4> instance_matrices(const Document& document, size_t index);

}  // namespace covtrace::gltf
