/// A tree over places on surfaces and the normals there, whose leaves hold about as many of the
/// places that it was built from as one another.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/vec.h"

namespace covtrace {

class PlaceTree {
  public:
    /// Where something was learnt.
    struct Place {
        Vec3 position, normal;  ///< of the surface, the unit normal on the side of the viewer
    };
    using Part = std::span<uint32_t>;  ///< indices of the places in a leaf

    /// Makes a tree without leaves.
    PlaceTree() = default;
    /// Builds the tree; a leaf has at most `most` places, or more where they cannot be told apart.
    /// `order` gets the indices of all places, leaf by leaf, and `parts` each leaf's part of it.
    PlaceTree(std::span<const Place> places, size_t most, std::vector<uint32_t>& order,
              std::vector<Part>& parts);

    bool is_empty() const { return nodes_.empty(); }
    /// The leaf, numbered as in `parts`, that a place with the unit normal n belongs to; not of an
    /// empty tree.
    uint32_t leaf(Vec3 position, Vec3 n) const {
        // An array is read at an axis without branches, and leaves lead to themselves so that all
        // walks are as long as one another: processors would guess branches wrong
        const std::array<float, 6> place{position.x, position.y, position.z, n.x, n.y, n.z};
        const Node* node = nodes_.data();
        for (int level = 0; level < depth_; ++level)
            node = &nodes_[node->child + (place[node->axis] >= node->split ? 1 : 0)];
        return node->leaf;
    }
    size_t memory() const { return nodes_.capacity() * sizeof(Node); }  ///< bytes

  private:
    /// No number is equal to it or above it.
    static constexpr float kNoSplit = std::numeric_limits<float>::quiet_NaN();

    struct Node {
        uint32_t axis = 0;  ///< 0 to 2: position; 3 to 5: normal
        float split = kNoSplit;
        uint32_t child = 0;  ///< the first of the node's two children, a leaf itself
        uint32_t leaf = 0;   ///< number of a leaf
    };
    class Builder;

    std::vector<Node> nodes_;
    int depth_ = 0;  ///< of the deepest leaf
};

}  // namespace covtrace
