/// The border of an emissive mesh: edges that belong to one triangle only, and the nearest of them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/vec.h"

namespace covtrace {

class BorderEdges {
  public:
    BorderEdges() = default;
    /// Finds the border edges of the triangles. Corners are the same where their coordinates are;
    /// triangles without area are left out.
    explicit BorderEdges(const std::vector<std::array<Vec3, 3>>& triangles);

    /// Point of the border nearest to p; empty for closed meshes.
    std::optional<Vec3> nearest(Vec3 p) const;
    size_t count() const { return edges_.size(); }

  private:
    struct Edge {
        Vec3 a, b;
    };
    /// One box of the hierarchy, over the edges [begin, end). An inner node is followed by its
    /// first child.
    struct Node {
        Bounds3 box;
        uint32_t begin = 0, end = 0;
        uint32_t second = 0;  ///< index of the second child; 0 for leaves
    };
    void build(uint32_t begin, uint32_t end);

    std::vector<Edge> edges_;
    std::vector<Node> nodes_;
};

}  // namespace covtrace
