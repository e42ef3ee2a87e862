#include "light/border.h"

#include <algorithm>
#include <tuple>

namespace covtrace {

namespace {

/// Edges in a leaf: a linear scan of so few is faster than descending further.
constexpr uint32_t kEdgesPerLeaf = 8;

bool before(Vec3 a, Vec3 b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

Vec3 nearest_on_segment(Vec3 a, Vec3 b, Vec3 p) {
    const Vec3 d = b - a;
    const float t = clamp01(dot(p - a, d) / dot(d, d));
    return a + d * t;
}

float squared_distance(const Bounds3& box, Vec3 p) {
    const Vec3 outside = max(Vec3{}, max(box.lo - p, p - box.hi));
    return length_squared(outside);
}

}  // namespace

BorderEdges::BorderEdges(const std::vector<std::array<Vec3, 3>>& triangles) {
    std::vector<Edge> all;
    all.reserve(3 * triangles.size());
    for (const auto& t : triangles) {
        if (!(length_squared(cross(t[1] - t[0], t[2] - t[0])) > 0)) continue;
        for (size_t i = 0; i < 3; ++i) {
            Vec3 a = t[i], b = t[(i + 1) % 3];
            if (before(b, a)) std::swap(a, b);
            all.push_back({a, b});
        }
    }
    std::sort(all.begin(), all.end(), [](const Edge& l, const Edge& r) {
        return l.a == r.a ? before(l.b, r.b) : before(l.a, r.a);
    });
    for (size_t i = 0; i < all.size();) {
        size_t same = i + 1;
        while (same < all.size() && all[same].a == all[i].a && all[same].b == all[i].b) ++same;
        if (same == i + 1) edges_.push_back(all[i]);
        i = same;
    }
    if (!edges_.empty()) build(0, static_cast<uint32_t>(edges_.size()));
}

void BorderEdges::build(uint32_t begin, uint32_t end) {
    const size_t index = nodes_.size();
    Node node;
    node.begin = begin;
    node.end = end;
    for (uint32_t i = begin; i < end; ++i) {
        node.box.extend(edges_[i].a);
        node.box.extend(edges_[i].b);
    }
    nodes_.push_back(node);
    if (end - begin <= kEdgesPerLeaf) return;
    const Vec3 d = node.box.diagonal();
    const int axis = d.x >= d.y && d.x >= d.z ? 0 : (d.y >= d.z ? 1 : 2);
    const uint32_t middle = (begin + end) / 2;
    std::nth_element(edges_.begin() + begin, edges_.begin() + middle, edges_.begin() + end,
                     [axis](const Edge& l, const Edge& r) {
                         return l.a[axis] + l.b[axis] < r.a[axis] + r.b[axis];
                     });
    build(begin, middle);
    nodes_[index].second = static_cast<uint32_t>(nodes_.size());
    build(middle, end);
}

std::optional<Vec3> BorderEdges::nearest(Vec3 p) const {
    if (nodes_.empty()) return std::nullopt;
    Vec3 best;
    float best_squared = kInfinity;
    std::array<uint32_t, 64> stack;  // halving 2^32 edges goes 32 deep
    size_t size = 0;
    stack[size++] = 0;
    while (size > 0) {
        const uint32_t index = stack[--size];
        const Node& node = nodes_[index];
        if (squared_distance(node.box, p) >= best_squared) continue;
        if (node.second == 0) {
            for (uint32_t i = node.begin; i < node.end; ++i) {
                const Vec3 q = nearest_on_segment(edges_[i].a, edges_[i].b, p);
                const float squared = length_squared(q - p);
                if (squared < best_squared) {
                    best_squared = squared;
                    best = q;
                }
            }
            continue;
        }
        // The nearer child is taken off the stack first.
        const uint32_t children[2] = {index + 1, node.second};
        const bool second_nearer = squared_distance(nodes_[children[1]].box, p) <
                                   squared_distance(nodes_[children[0]].box, p);
        stack[size++] = children[second_nearer ? 0 : 1];
        stack[size++] = children[second_nearer ? 1 : 0];
    }
    if (!(best_squared < kInfinity)) return std::nullopt;
    return best;
}

}  // namespace covtrace
