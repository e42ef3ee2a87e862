#include "occluders/blind_cones.h"

#include <algorithm>
#include <cmath>

namespace covtrace {

namespace {

/// A double cone of lines about an axis; one with a half angle of 90 degrees holds all lines.
struct Cone {
    Vec3 axis{0, 0, 1};
    float cosine = 0, sine = 1;
};

/// The cone about the middle of the wedge at an edge. The edge is no outline for lines of sight
/// inside of the wedge or of its mirror image.
Cone cone_of(const FoldEdge& e) {
    // The wedge is spanned by the directions from the edge into its two outer faces.
    const Vec3 along = normalize(e.b - e.a);
    const Vec3 u = cross(e.normal0, along), v = cross(e.normal1, along), sum = u + v;
    const float l = length(sum);
    // An edge that is almost flat has the middle of its wedge at right angles to the surface, whose
    // normal is safer to compute.
    if (!(l > 1e-3f)) {
        const float angle = 1e-3f;
        return {normalize(e.normal0 - e.normal1), std::cos(angle), angle};
    }
    const float half = std::min(1.0f, 0.5f * l);
    return {sum / l, safe_sqrt(1 - half * half), half};
}

using Tensor = std::array<float, 6>;

Vec3 times(const Tensor& t, Vec3 v) {
    return {t[0] * v.x + t[3] * v.y + t[4] * v.z, t[3] * v.x + t[1] * v.y + t[5] * v.z,
            t[4] * v.x + t[5] * v.y + t[2] * v.z};
}

/// The direction in which most of a tensor lies.
Vec3 main_axis(const Tensor& t) {
    Vec3 v = t[0] >= t[1] && t[0] >= t[2] ? Vec3{1, 0, 0}
                                          : (t[1] >= t[2] ? Vec3{0, 1, 0} : Vec3{0, 0, 1});
    for (int i = 0; i < 12; ++i) {
        const Vec3 next = times(t, v);
        const float l = length(next);
        if (!(l > 0)) break;
        v = next / l;
    }
    return v;
}

/// Edges [begin, end) of the hierarchy's order.
struct Range {
    size_t begin = 0, end = 0;
};

/// A cone that holds the cones of all edges in a range, a little wider to make up for rounding.
Cone cone_of(const std::vector<Cone>& cones, Range r) {
    Tensor sum{};
    for (size_t i = r.begin; i < r.end; ++i) {
        const Vec3 a = cones[i].axis;
        const Tensor t{a.x * a.x, a.y * a.y, a.z * a.z, a.x * a.y, a.x * a.z, a.y * a.z};
        for (size_t k = 0; k < 6; ++k) sum[k] += cones[i].cosine * t[k];
    }
    const Vec3 axis = main_axis(sum);
    float least = 1;  // cosine of the angle at which a cone ends
    for (size_t i = r.begin; i < r.end && least > 0; ++i) {
        const float c = std::min(1.0f, std::abs(dot(axis, cones[i].axis)));
        least = std::min(least, c * cones[i].cosine - safe_sqrt(1 - c * c) * cones[i].sine);
    }
    if (!(least > 0)) return {};
    const float angle = std::min(std::acos(std::min(1.0f, least)) + 2e-3f, 0.5f * kPi);
    return {axis, std::cos(angle), std::sin(angle)};
}

}  // namespace

std::vector<BlindCones> blind_cones(const BoxHierarchy& hierarchy,
                                    const std::vector<FoldEdge>& edges) {
    using Node = BoxHierarchy::Node;
    std::vector<Cone> cones(edges.size());
    for (size_t i = 0; i < edges.size(); ++i) cones[i] = cone_of(edges[i]);
    std::vector<Range> of_item(hierarchy.items());
    for (size_t i = 0, at = 0; i < of_item.size(); ++i) {
        of_item[i] = {at, at + hierarchy.item(i).size()};
        at = of_item[i].end;
    }
    const std::vector<Node>& nodes = hierarchy.nodes();
    std::vector<Range> of_node(nodes.size());
    const auto range_of = [&](uint32_t child) {
        return child < BoxHierarchy::kItem ? of_node[child] : of_item[child - BoxHierarchy::kItem];
    };
    // Nodes are visited from the last to the first, so that children come before their parents;
    // their edges follow each other.
    for (size_t i = nodes.size(); i-- > 0;)
        for (uint32_t child : nodes[i].child) {
            if (child == BoxHierarchy::kNone) continue;
            const Range r = range_of(child);
            of_node[i] = {of_node[i].end > 0 ? of_node[i].begin : r.begin, r.end};
        }
    std::vector<BlindCones> all(nodes.size());
    for (size_t i = 0; i < nodes.size(); ++i)
        for (size_t k = 0; k < BoxHierarchy::kWidth; ++k) {
            const uint32_t child = nodes[i].child[k];
            if (child == BoxHierarchy::kNone) continue;
            const Cone cone = cone_of(cones, range_of(child));
            all[i].axis.x[k] = cone.axis.x;
            all[i].axis.y[k] = cone.axis.y;
            all[i].axis.z[k] = cone.axis.z;
            all[i].cosine[k] = cone.cosine;
            all[i].sine2[k] = sqr(cone.sine);
            const Vec3x8& h = nodes[i].half;
            all[i].radius[k] = length(Vec3{h.x[k], h.y[k], h.z[k]});
        }
    return all;
}

}  // namespace covtrace
