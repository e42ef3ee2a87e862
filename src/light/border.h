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
    /// Corners are the same where their coordinates are. Triangles without area are left out.
    explicit BorderEdges(const std::vector<std::array<Vec3, 3>>& triangles);

    /// Point of the border nearest to p; empty for closed meshes.
    std::optional<Vec3> nearest(Vec3 p) const;
    size_t count() const { return edges_.size(); }

  private:
    struct Edge {
        Vec3 a, b;
    };
    /// A box over edges [begin, end); inner nodes are followed by their first child.
    struct Node {
        Bounds3 box;
        uint32_t begin = 0, end = 0;
        uint32_t second = 0;  ///< child; 0 for leaves
    };
    void build(uint32_t begin, uint32_t end);

    std::vector<Edge> edges_;
    std::vector<Node> nodes_;
};

}  // namespace covtrace
