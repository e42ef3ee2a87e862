#include "occluders/edge_block.h"

#include <limits>

namespace covtrace {

namespace {

/// Sets lane k.
void put(Vec3x8& to, size_t k, Vec3 v) {
    to.x[k] = v.x;
    to.y[k] = v.y;
    to.z[k] = v.z;
}

}  // namespace

EdgeBlock::EdgeBlock(std::span<const FoldEdge> edges) {
    // With NaN every comparison fails, so that a lane without an edge is never an outline.
    const float none = std::numeric_limits<float>::quiet_NaN();
    a = {all8(none), all8(none), all8(none)};
    for (size_t k = 0; k < edges.size(); ++k) {
        put(a, k, edges[k].a);
        put(along, k, edges[k].b - edges[k].a);
        put(normal0, k, edges[k].normal0);
        put(normal1, k, edges[k].normal1);
    }
}

}  // namespace covtrace
