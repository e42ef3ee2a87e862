/// Eight edges side by side, so that a search tests them together.
#pragma once

#include <span>
#include <vector>

#include "geometry/float8.h"
#include "geometry/fold_edges.h"

namespace covtrace {

struct EdgeBlock {
    /// Of FoldEdge, `along` from a to b; `a` is no number where there is no edge.
    Vec3x8 a, along, normal0, normal1;

    EdgeBlock() = default;
    /// Of up to eight edges.
    explicit EdgeBlock(std::span<const FoldEdge> edges);
    FoldEdge edge(size_t k) const;

    /// All bits set where an edge may be an outline from who looks; `from`: there to `a`.
    auto may_be_outlines(const Vec3x8& from) const {
        return dot8(from, normal0) * dot8(from, normal1) > Float8{};
    }
};

}  // namespace covtrace
