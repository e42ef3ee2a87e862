#include "geometry/edge_block.h"

#include <limits>

namespace covtrace {

namespace {

void put(Vec3x8& to, size_t k, Vec3 v) {
    to.x[k] = v.x;
    to.y[k] = v.y;
    to.z[k] = v.z;
}
Vec3 get(const Vec3x8& from, size_t k) {
    return {from.x[k], from.y[k], from.z[k]};
}

}  // namespace

EdgeBlock::EdgeBlock(std::span<const FoldEdge> edges) {
    const float none = std::numeric_limits<float>::quiet_NaN();
    a = {all8(none), all8(none), all8(none)};
    for (size_t k = 0; k < edges.size(); ++k) {
        put(a, k, edges[k].a);
        put(along, k, edges[k].b - edges[k].a);
        put(normal0, k, edges[k].normal0);
        put(normal1, k, edges[k].normal1);
    }
}

FoldEdge EdgeBlock::edge(size_t k) const {
    const Vec3 from = get(a, k);
    return {from, from + get(along, k), get(normal0, k), get(normal1, k)};
}

}  // namespace covtrace
