/// The edges of triangles that can be seen as outlines: borders and folds. Flat neighbours, of
/// which most meshes have many, leave no edge between them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/vec.h"
#include "geometry/box_hierarchy.h"

namespace covtrace {

/// An edge from `a` to `b` and the wedge that the surfaces around it fill: from p the edge is an
/// outline where all of them lie on one side of the plane through p, a and b.
struct FoldEdge {
    Vec3 a, b;
    /// The two outer faces' directions away from the edge, across it: cosine and sine in
    /// Frame::from_z(normalize(b - a)), in parts of 32767.
    std::array<int16_t, 2> face0{}, face1{};

    /// Whether `p` sees the edge as an outline. Where p is in the plane of a face itself, as a
    /// point of that face is, it is none.
    bool is_outline_from(Vec3 p) const;
};

/// Double cones of lines of sight that see no outline: those within 90 degrees less `angle` of the
/// axis see the edges from the front (or the back) on both sides. Side by side, as the nodes of a
/// BoxHierarchy.
struct BlindCones {
    std::array<Float8, 3> axis{};
    Float8 cosine{}, sine2 = Float8{} + 1;  ///< of `angle`; the sine squared
    Float8 radius{};                        ///< of the boxes

    /// Infinity where no edge in a box of `node` is an outline from `p`, elsewhere `lower`.
    Float8 rule_out(const BoxHierarchy::Node& node, Vec3 p, const Float8& lower) const {
        const Float8 x = node.middle[0] - p.x, y = node.middle[1] - p.y, z = node.middle[2] - p.z;
        const Float8 dot = x * axis[0] + y * axis[1] + z * axis[2], along2 = dot * dot;
        const Float8 across2 = max8(x * x + y * y + z * z - along2, Float8{});
        const Float8 inside = abs8(dot) * cosine - radius;
        // Both sides of `inside > across sine` squared.
        return ((inside > 0) & (inside * inside > across2 * sine2)) ? all8(kInfinity) : lower;
    }
};

/// Of every node of a hierarchy over `edges`, which are in its order.
std::vector<BlindCones> blind_cones(const BoxHierarchy& hierarchy,
                                    const std::vector<FoldEdge>& edges);

/// Collects triangles, of one space, and finds their edges. Corners at the very same place are one,
/// whichever mesh they are of.
class FoldEdgeFinder {
  public:
    /// Corners that are not finite drop their triangle.
    void add(const std::vector<Vec3>& positions,
             const std::vector<std::array<uint32_t, 3>>& triangles);
    /// In an order that depends on what was added alone; forgets everything.
    std::vector<FoldEdge> take();

  private:
    uint32_t weld(Vec3 position);
    void grow();

    std::vector<Vec3> corners_;
    std::vector<uint32_t> table_;  ///< open addressing by the position's bits
    std::vector<std::array<uint32_t, 3>> triangles_;
};

}  // namespace covtrace
