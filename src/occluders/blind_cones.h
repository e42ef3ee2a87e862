/// Directions from which none of the edges in a box is an outline.
#pragma once

#include <vector>

#include "occluders/box_hierarchy.h"
#include "occluders/fold_edges.h"

namespace covtrace {

/// Double cones of lines of sight that see no outline, for the eight boxes of a node of a
/// BoxHierarchy. Lines within 90 degrees less `angle` of the axis see all edges of the box from the
/// front (or from the back) on both sides.
struct BlindCones {
    Vec3x8 axis;
    Float8 cosine{}, sine2 = Float8{} + 1;  ///< cosine, and squared sine, of `angle`
    Float8 radius{};                        ///< half the diagonals of the boxes

    /// The boxes in which no edge is an outline; `middle`: their middles, seen from the viewer.
    Mask8 hide(const Vec3x8& middle) const {
        const Float8 along = abs8(dot8(middle, axis));
        const Float8 across2 = max8(subtract_product(along, along, dot8(middle, middle)), Float8{});
        const Float8 inside = multiply_add(along, cosine, -radius);
        // The inequality is `inside > across sine`, squared on both sides with the sign of the left
        // one.
        return inside * abs8(inside) > across2 * sine2;
    }
};

/// The blind cones of every node of a hierarchy over edges; `edges`: in the order of its items.
std::vector<BlindCones> blind_cones(const BoxHierarchy& hierarchy,
                                    const std::vector<FoldEdge>& edges);

}  // namespace covtrace
