/// Eight edges side by side, so that a search tests them together.
#pragma once

#include <span>
#include <vector>

#include "occluders/float8.h"
#include "occluders/fold_edges.h"

namespace covtrace {

struct EdgeBlock {
    /// Of FoldEdge, `along` from a to b; `a` is no number where there is no edge.
    Vec3x8 a, along, normal0, normal1;

    EdgeBlock() = default;
    /// Of up to eight edges.
    explicit EdgeBlock(std::span<const FoldEdge> edges);

    /// Where an edge is an outline from p, `from`: there to `a`: all surfaces around it lie on one
    /// side of the plane through p and the edge. Where p is in the plane of a face itself, as a
    /// point of that face is, it is none.
    Mask8 are_outlines(const Vec3x8& from) const {
        const Float8 s0 = dot8(from, normal0), s1 = dot8(from, normal1);
        const Float8 least = min8(abs8(s0), abs8(s1)), in_plane = all8(kInPlane * kInPlane);
        // Beside the distance from the edge's line.
        const Vec3x8 moment = cross8(from, along);
        return (s0 * s1 > Float8{}) &
               (least * least * dot8(along, along) > in_plane * dot8(moment, moment));
    }

  private:
    /// Sine below which a point counts as in the plane of a face: a few times what the rounding of
    /// hit points gives at a thousandth of the scene's size.
    static constexpr float kInPlane = 1e-3f;
};

}  // namespace covtrace
