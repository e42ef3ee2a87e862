#include <algorithm>
#include <cmath>

#include "core/frame.h"
#include "geometry/fold_edges.h"

namespace covtrace {

namespace {

/// Lines about an axis; an angle of 90 degrees and more holds all.
struct Cone {
    Vec3 axis{0, 0, 1};
    float angle = -1;  ///< below 0: empty

    void add(const Cone& other) {
        if (other.angle < 0) return;
        if (angle < 0) {
            *this = other;
            return;
        }
        const Vec3 turned = dot(axis, other.axis) < 0 ? -other.axis : other.axis;
        const float apart = std::acos(std::min(1.0f, dot(axis, turned)));
        if (apart + other.angle <= angle) return;
        if (apart + angle <= other.angle) {
            *this = other;
            return;
        }
        const Vec3 middle = axis + turned;
        const float l = length(middle);
        angle = l > 0 ? 0.5f * apart + std::max(angle, other.angle) : 0.5f * kPi;
        if (l > 0) axis = middle / l;
    }
};

/// The middle of the wedge about an edge; the edge is no outline for lines of sight inside of the
/// wedge or of its mirror image.
Cone cone_of(const FoldEdge& e) {
    const Frame frame = Frame::from_z(normalize(e.b - e.a));
    const auto direction = [&](const std::array<int16_t, 2>& face) {
        return (frame.x * static_cast<float>(face[0]) + frame.y * static_cast<float>(face[1])) /
               32767;
    };
    const Vec3 u = direction(e.face0), v = direction(e.face1), sum = u + v;
    const float l = length(sum);
    // Almost flat: the middle is at right angles to the surface, whose normal is safer.
    if (!(l > 1e-3f)) return {normalize(cross(u - v, e.b - e.a)), 1e-3f};
    return {sum / l, 0.5f * kPi - std::acos(std::min(1.0f, 0.5f * l))};
}

}  // namespace

std::vector<BlindCones> blind_cones(const BoxHierarchy& hierarchy,
                                    const std::vector<FoldEdge>& edges) {
    using Node = BoxHierarchy::Node;
    const std::vector<Node>& nodes = hierarchy.nodes();
    std::vector<BlindCones> all(nodes.size());
    std::vector<Cone> of_node(nodes.size());
    for (size_t i = nodes.size(); i-- > 0;) {
        for (size_t k = 0; k < BoxHierarchy::kWidth; ++k) {
            const uint32_t child = nodes[i].child[k];
            if (child == BoxHierarchy::kNone) continue;
            const Cone cone = child < BoxHierarchy::kItem
                                  ? of_node[child]
                                  : cone_of(edges[child - BoxHierarchy::kItem]);
            of_node[i].add(cone);
            // A little more, for what add and the quantised wedges round.
            const float angle = std::min(cone.angle + 1e-3f, 0.5f * kPi);
            for (int axis = 0; axis < 3; ++axis)
                all[i].axis[static_cast<size_t>(axis)][k] = cone.axis[axis];
            all[i].cosine[k] = angle < 0.5f * kPi ? std::cos(angle) : 0.0f;
            all[i].sine2[k] = angle < 0.5f * kPi ? sqr(std::sin(angle)) : 1.0f;
            const auto& half = nodes[i].half;
            all[i].radius[k] = length(Vec3{half[0][k], half[1][k], half[2][k]});
        }
    }
    return all;
}

}  // namespace covtrace
