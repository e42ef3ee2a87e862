/// Eight edges side by side, so that a search tests them together.
#pragma once

#include <span>
#include <vector>

#include "occluders/fold_edges.h"
#include "occluders/vec3x8.h"

namespace covtrace {

struct EdgeBlock {
    /// The eight edges as FoldEdge has them, `along` from a to b; `a` is NaN where there is no
    /// edge.
    Vec3x8 a, along, normal0, normal1;

    EdgeBlock() = default;
    /// Makes a block of up to eight edges.
    explicit EdgeBlock(std::span<const FoldEdge> edges);

    /// The edges that are outlines seen from a point p, where `from` is the way from p to `a`: all
    /// surfaces around such an edge lie on one side of the plane through p and the edge. An edge
    /// with p in the plane of one of its faces, as a point of that face is, is no outline.
    Mask8 are_outlines(const Vec3x8& from) const {
        const Float8 s0 = dot8(from, normal0), s1 = dot8(from, normal1);
        const Float8 least = min8(abs8(s0), abs8(s1)), in_plane = all8(kInPlane * kInPlane);
        // The limit kInPlane is relative to the distance of p from the edge's line, |moment| /
        // |along|.
        const Vec3x8 moment = cross8(from, along);
        return (s0 * s1 > Float8{}) &
               (least * least * dot8(along, along) > in_plane * dot8(moment, moment));
    }

  private:
    /// Sine of an angle below which a point counts as in the plane of a face: a few times what the
    /// rounding of hit points gives at a thousandth of the scene's size.
    static constexpr float kInPlane = 1e-3f;
};

}  // namespace covtrace
