/// From where the edges in a box are no outlines, whichever of them one looks at.
#pragma once

#include <vector>

#include "occluders/box_hierarchy.h"
#include "occluders/fold_edges.h"

namespace covtrace {

/// Double cones of lines of sight that see no outline: those within 90 degrees less `angle` of the
/// axis see the edges from the front (or the back) on both sides. Side by side, as the nodes of a
/// BoxHierarchy.
struct BlindCones {
    Vec3x8 axis;
    Float8 cosine{}, sine2 = Float8{} + 1;  ///< of `angle`; the sine squared
    Float8 radius{};                        ///< of the boxes

    /// Where no edge in a box is an outline; `middle`: of the boxes, from who looks.
    Mask8 hide(const Vec3x8& middle) const {
        const Float8 along = abs8(dot8(middle, axis));
        const Float8 across2 = max8(less_product8(along, along, dot8(middle, middle)), Float8{});
        const Float8 inside = add_product8(along, cosine, -radius);
        // Both sides of `inside > across sine` squared, with the sign of the left one.
        return inside * abs8(inside) > across2 * sine2;
    }
};

/// Of every node of a hierarchy over edges; `edges`: in the order of its items.
std::vector<BlindCones> blind_cones(const BoxHierarchy& hierarchy,
                                    const std::vector<FoldEdge>& edges);

}  // namespace covtrace
