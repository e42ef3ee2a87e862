/// A hierarchy of boxes for searches that Embree does not offer. Four boxes per node side by side,
/// so that a search tests them together.
#pragma once

#include <immintrin.h>

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "core/vec.h"

namespace covtrace {

/// Four floats that are computed with together.
using Float4 __attribute__((vector_size(16))) = float;
inline Float4 max4(Float4 a, Float4 b) {
    return a > b ? a : b;
}
inline Float4 min4(Float4 a, Float4 b) {
    return a < b ? a : b;
}
inline Float4 abs4(Float4 a) {
    return max4(a, -a);
}
/// Bit k tells whether a[k] < b.
inline unsigned below4(Float4 a, float b) {
    return static_cast<unsigned>(_mm_movemask_ps(reinterpret_cast<__m128>(a < Float4{} + b)));
}

class BoxHierarchy {
  public:
    static constexpr int kWidth = 4;
    static constexpr uint32_t kMostInLeaf = 1;

    struct Node {
        /// Middles and half sizes of the children's boxes, by axis; no number where there is none,
        /// so that every comparison fails.
        std::array<Float4, 3> middle{}, half{};
        std::array<uint32_t, kWidth> first{};  ///< a node, or the first item of a leaf
        std::array<uint8_t, kWidth> count{};   ///< items of a leaf, kInner or kNone
        static constexpr uint8_t kInner = 255, kNone = 0;
    };

    BoxHierarchy() = default;
    /// The same for any number of threads. Fewer than 2^31 boxes, none of them empty.
    explicit BoxHierarchy(std::span<const Bounds3> boxes);

    bool empty() const { return nodes_.empty(); }
    /// The root is the first; parents come before their children.
    const std::vector<Node>& nodes() const { return nodes_; }
    /// Item i of the leaves is box order()[i].
    const std::vector<uint32_t>& order() const { return order_; }
    const Bounds3& bounds() const { return bounds_; }
    size_t memory() const {
        return nodes_.capacity() * sizeof(Node) + order_.capacity() * sizeof(uint32_t);
    }

    /// Best first. bounds(node, index) gives a lower bound on what is wanted for each of the node's
    /// four boxes; children at or above limit() are left out;
    /// visit(item) is called for all items of the leaves that remain.
    template <class LowerBounds, class Limit, class Visit>
    void search(const LowerBounds& bounds, const Limit& limit, const Visit& visit) const;

  private:
    struct Builder;
    static constexpr int kMostDepth = 32;

    std::vector<Node> nodes_;
    std::vector<uint32_t> order_;
    Bounds3 bounds_;
};

template <class LowerBounds, class Limit, class Visit>
void BoxHierarchy::search(const LowerBounds& bounds, const Limit& limit, const Visit& visit) const {
    struct Entry {
        float bound;
        uint32_t first;
        uint8_t count;
    };
    std::array<Entry, kMostDepth * kWidth> stack;
    if (nodes_.empty()) return;
    stack[0] = {0, 0, Node::kInner};
    for (size_t size = 1; size > 0;) {
        const Entry e = stack[--size];
        if (!(e.bound < limit())) continue;
        if (e.count != Node::kInner) {
            for (uint32_t i = e.first; i < e.first + e.count; ++i) visit(i);
            continue;
        }
        const Node& node = nodes_[e.first];
        const Float4 lower = bounds(node, e.first);
        const size_t base = size;
        for (unsigned below = below4(lower, limit()); below != 0; below &= below - 1) {
            const auto k = static_cast<size_t>(std::countr_zero(below));
            // Farthest at the bottom.
            size_t at = size++;
            for (; at > base && stack[at - 1].bound < lower[k]; --at) stack[at] = stack[at - 1];
            stack[at] = {lower[k], node.first[k], node.count[k]};
        }
    }
}

}  // namespace covtrace
