/// Private to this folder: the node hierarchy, flattened to placed nodes.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/transform.h"
#include "gltf/animation.h"
#include "gltf/document.h"

namespace covtrace::gltf {

struct PlacedNode {
    int node = -1;                ///< into the document's nodes
    AnimatedTransform transform;  ///< node to world, over the shutter
};

/// Matrices from a node's space to the world's at both ends of the shutter. They may be singular,
/// as joints are scaled to nothing to hide what they carry.
using WorldMatrices = std::array<Matrix4, 2>;

struct PlacedNodes {
    std::vector<PlacedNode> nodes;  ///< parents before children, in the file's order
    std::vector<std::optional<WorldMatrices>>
        worlds;  ///< one for each of the document's nodes; none: not in the scene
};

/// Weights of the morph targets of the node's mesh at a time; missing ones are 0.
std::vector<double> morph_weights(const Document& document, const Animations& animations, int node,
                                  double time);

/// The nodes of a scene, by its index (-1: all roots, where there are no scenes), as the animations
/// move them. A node that the scene lists beside one above it is placed once, by its parents; one
/// whose parents are not in the scene by its own transform; both with a warning. Refuses nodes with
/// two parents and cycles. Nodes that a scale of zero or KHR_node_visibility hides are left out of
/// the placed ones; those whose mesh EXT_mesh_gpu_instancing copies are there once for each copy.
///
/// `shutter`: both ends in seconds.
PlacedNodes place_nodes(const Document& document, int scene, const Animations& animations,
                        const std::array<float, 2>& shutter, WarningLog& log);

}  // namespace covtrace::gltf
