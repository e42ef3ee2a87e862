/// Private to this folder: the node hierarchy, flattened to placed nodes.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/transform.h"
#include "gltf/document.h"

namespace covtrace::gltf {

struct PlacedNode {
    int node = -1;                ///< into the document's nodes
    AnimatedTransform transform;  ///< node to world, over the shutter
};

/// The nodes of the document's default scene (the first one, where none is named; all roots, where
/// there are no scenes), parents before children, in the file's order. Refuses nodes with two
/// parents, which cycles are made of. What a scale of zero hides is left out.
/// `shutter`: both ends in seconds; none: at rest, as at time 0 of the animations.
std::vector<PlacedNode> place_nodes(const Document& document,
                                    const std::optional<std::array<float, 2>>& shutter,
                                    WarningLog& log);

}  // namespace covtrace::gltf
