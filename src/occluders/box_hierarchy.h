/// A hierarchy of boxes for searches that Embree does not offer. Eight boxes per node side by side,
/// so that a search tests them together.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/vec.h"
#include "occluders/vec3x8.h"

namespace covtrace {

class BoxHierarchy {
  public:
    static constexpr int kWidth = 8;

    struct Node {
        /// Middles and half sizes of the children's boxes; NaN where there is no child, so that
        /// every comparison fails.
        Vec3x8 middle, half;
        /// Index of a node, or kItem + index of an item, or kNone.
        std::array<uint32_t, kWidth> child{};
    };
    static constexpr uint32_t kItem = uint32_t{1} << 31, kNone = ~uint32_t{0};

    BoxHierarchy() = default;
    /// Builds a hierarchy over items of up to `per_item` boxes each. The result is the same for any
    /// number of threads. Fewer than 2^31 - 1 boxes, none of them empty. It is empty once
    /// `cancelled`, asked from any thread, says yes.
    explicit BoxHierarchy(std::span<const Bounds3> boxes, uint32_t per_item = 1,
                          const std::function<bool()>& cancelled = {});
    /// The same on the calling thread alone, as in the midst of a path: where many threads share
    /// the work, one that waits for the others takes up another path.
    static BoxHierarchy by_one_thread(std::span<const Bounds3> boxes, uint32_t per_item);

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

    /// The answer of a search to one node: which of its eight boxes to enter, and how near they may
    /// be.
    struct Met {
        unsigned bits = 0;  ///< bit k tells whether the k-th box is met
        /// A bound for each box, numerator / denominator, which no item in it is below.
        Float8 numerator, denominator;
    };
    /// Calls visit(item) for the items whose boxes, and all boxes around them, are met by
    /// meets(node, index). The box of a node with the least bound comes first. Boxes whose bound is
    /// no longer below limit() when their turn comes are left out: among thousands of items that
    /// are all near, the first ones that are found spare the rest.
    template <class Meets, class Limit, class Visit>
    void search(const Meets& meets, const Limit& limit, const Visit& visit) const;

  private:
    struct Builder;
    static constexpr int kMostDepth = 32;

    std::vector<Node> nodes_;
    std::vector<uint32_t> order_, first_{0};
    Bounds3 bounds_;
};

template <class Meets, class Limit, class Visit>
void BoxHierarchy::search(const Meets& meets, const Limit& limit, const Visit& visit) const {
    struct Waiting {
        uint32_t child;
        float bound;
    };
    std::array<Waiting, kMostDepth * kWidth> stack;
    if (nodes_.empty()) return;
    size_t size = 0;
    // A single item needs no look at its box.
    for (uint32_t next = items() == 1 ? kItem : 0;;) {
        if (next < kItem) {
            const Node& node = nodes_[next];
            const Met met = meets(node, next);
            unsigned left = met.bits;
            if (std::has_single_bit(left)) {
                next = node.child[static_cast<size_t>(std::countr_zero(left))];
                continue;
            }
            if (left != 0) {
                const Float8 bounds = met.numerator / met.denominator;
                const size_t first = size;
                for (; left != 0; left &= left - 1) {
                    const auto k = static_cast<size_t>(std::countr_zero(left));
                    size_t at = size++;
                    for (; at > first && stack[at - 1].bound < bounds[k]; --at)
                        stack[at] = stack[at - 1];
                    stack[at] = {node.child[k], bounds[k]};
                }
            }
        } else {
            visit(next - kItem);
        }
        do {
            if (size == 0) return;
            next = stack[--size].child;
        } while (stack[size].bound > limit());
    }
}

}  // namespace covtrace
