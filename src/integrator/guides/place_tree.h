/// A tree over places on surfaces and the normals there, whose leaves hold about as many of the
/// places that it was built from as one another.
#pragma once

#include <cstddef>
#include <cstdint>
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
        const Node* node = nodes_.data();
        while (node->axis >= 0) {
            const float x = node->axis < 3 ? position[node->axis] : n[node->axis - 3];
            node = &nodes_[node->child + (x < node->split ? 0 : 1)];
        }
        return node->child;
    }
    size_t memory() const { return nodes_.capacity() * sizeof(Node); }  ///< bytes

  private:
    struct Node {
        int axis = -1;  ///< 0 to 2: position; 3 to 5: normal; -1: a leaf
        float split = 0;
        uint32_t child = 0;  ///< the first of the node's two children, for a leaf its number
    };
    class Builder;

    std::vector<Node> nodes_;
};

}  // namespace covtrace
