/// Edges in a hierarchy, eight side by side, for searches.
#pragma once

#include <vector>

#include "occluders/blind_cones.h"
#include "occluders/box_hierarchy.h"
#include "occluders/edge_block.h"
#include "occluders/fold_edges.h"

namespace covtrace {

/// Edges of one body, in the local space of a scene of Embree.
struct EdgeSet {
    size_t count = 0;
    BoxHierarchy hierarchy;
    std::vector<EdgeBlock> blocks;  ///< its items, in their order
    std::vector<BlindCones> cones;  ///< for each node of the hierarchy

    explicit EdgeSet(const std::vector<FoldEdge>& found);

    size_t memory() const {
        return sizeof *this + hierarchy.memory() + blocks.capacity() * sizeof(EdgeBlock) +
               cones.capacity() * sizeof(BlindCones);
    }
};

}  // namespace covtrace
