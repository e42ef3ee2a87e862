#include "occluders/edge_set.h"

namespace covtrace {

EdgeSet::EdgeSet(const std::vector<FoldEdge>& found) : count(found.size()) {
    std::vector<Bounds3> boxes(count);
    for (size_t i = 0; i < count; ++i) {
        boxes[i].extend(found[i].a);
        boxes[i].extend(found[i].b);
    }
    hierarchy = BoxHierarchy::by_one_thread(boxes, BoxHierarchy::kWidth);
    std::vector<FoldEdge> edges;
    edges.reserve(count);
    blocks.reserve(hierarchy.items());
    for (size_t i = 0; i < hierarchy.items(); ++i) {
        for (uint32_t k : hierarchy.item(i)) edges.push_back(found[k]);
        blocks.emplace_back(std::span(edges).last(hierarchy.item(i).size()));
    }
    cones = blind_cones(hierarchy, edges);
}

}  // namespace covtrace
