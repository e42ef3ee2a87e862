/// A hierarchy of boxes for searches that Embree does not offer. Eight boxes per node side by side,
/// so that a search tests them together.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "core/vec.h"
#include "geometry/float8.h"

namespace covtrace {

class BoxHierarchy {
  public:
    static constexpr int kWidth = 8;

    struct Node {
        /// Middles and half sizes of the children's boxes; no number where there is none, so that
        /// every comparison fails.
        Vec3x8 middle, half;
        /// A node, or kItem + an item, or kNone.
        std::array<uint32_t, kWidth> child{};
    };
    static constexpr uint32_t kItem = uint32_t{1} << 31, kNone = ~uint32_t{0};

    BoxHierarchy() = default;
    /// Items of up to `per_item` boxes each. The same for any number of threads. Fewer than 2^31 -
    /// 1 boxes, none of them empty.
    explicit BoxHierarchy(std::span<const Bounds3> boxes, uint32_t per_item = 1);

    bool empty() const { return nodes_.empty(); }
    /// The root is the first; parents come before their children.
    const std::vector<Node>& nodes() const { return nodes_; }
    size_t items() const { return first_.size() - 1; }
    /// The boxes of an item.
    std::span<const uint32_t> item(size_t i) const {
        return std::span(order_).subspan(first_[i], first_[i + 1] - first_[i]);
    }
    const Bounds3& bounds() const { return bounds_; }
    size_t memory() const {
        return nodes_.capacity() * sizeof(Node) +
               (order_.capacity() + first_.capacity()) * sizeof(uint32_t);
    }

    /// Calls visit(item) for the items whose boxes, and all boxes around them, are met: bit k of
    /// meets(node, index) tells so of the node's k-th. Not best first: most searches find nothing,
    /// and no order makes them shorter.
    template <class Meets, class Visit>
    void search(const Meets& meets, const Visit& visit) const;

  private:
    struct Builder;
    static constexpr int kMostDepth = 32;

    std::vector<Node> nodes_;
    std::vector<uint32_t> order_, first_{0};
    Bounds3 bounds_;
};

template <class Meets, class Visit>
void BoxHierarchy::search(const Meets& meets, const Visit& visit) const {
    std::array<uint32_t, kMostDepth * kWidth> stack;
    if (nodes_.empty()) return;
    size_t size = 0;
    // A single item needs no look at its box.
    for (uint32_t next = items() == 1 ? kItem : 0;;) {
        if (next < kItem) {
            const Node& node = nodes_[next];
            unsigned left = meets(node, next);
            if (std::has_single_bit(left)) {
                next = node.child[static_cast<size_t>(std::countr_zero(left))];
                continue;
            }
            for (; left != 0; left &= left - 1)
                stack[size++] = node.child[static_cast<size_t>(std::countr_zero(left))];
        } else {
            visit(next - kItem);
        }
        if (size == 0) return;
        next = stack[--size];
    }
}

}  // namespace covtrace
