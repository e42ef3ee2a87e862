/// A hierarchy of boxes for searches that Embree does not offer. Eight boxes per node side by side,
/// so that a search tests them together.
#pragma once

#include <immintrin.h>

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "core/vec.h"

// How such vectors are passed depends on the processor that is compiled for, which is one for all
// of the program.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace covtrace {

/// Eight floats that are computed with together.
using Float8 __attribute__((vector_size(32))) = float;
inline Float8 all8(float a) {
    return Float8{a, a, a, a, a, a, a, a};
}
/// a > b ? a : b, for which compilers take two instructions.
inline Float8 max8(const Float8& a, const Float8& b) {
#ifdef __AVX__
    return reinterpret_cast<Float8>(
        _mm256_max_ps(reinterpret_cast<__m256>(a), reinterpret_cast<__m256>(b)));
#else
    return a > b ? a : b;
#endif
}
/// a < b ? a : b.
inline Float8 min8(const Float8& a, const Float8& b) {
#ifdef __AVX__
    return reinterpret_cast<Float8>(
        _mm256_min_ps(reinterpret_cast<__m256>(a), reinterpret_cast<__m256>(b)));
#else
    return a < b ? a : b;
#endif
}
inline Float8 abs8(const Float8& a) {
    return max8(a, -a);
}
/// Bit k tells whether a[k] < b.
inline unsigned below8(const Float8& a, float b) {
    const auto below = a < all8(b);
#ifdef __AVX__
    return static_cast<unsigned>(_mm256_movemask_ps(reinterpret_cast<__m256>(below)));
#else
    unsigned mask = 0;
    for (unsigned k = 0; k < 8; ++k) mask |= below[k] != 0 ? 1u << k : 0u;
    return mask;
#endif
}

class BoxHierarchy {
  public:
    static constexpr int kWidth = 8;

    struct Node {
        /// Middles and half sizes of the children's boxes, by axis; no number where there is none,
        /// so that every comparison fails.
        std::array<Float8, 3> middle{}, half{};
        /// A node, or kItem + an item, or kNone.
        std::array<uint32_t, kWidth> child{};
    };
    static constexpr uint32_t kItem = uint32_t{1} << 31, kNone = ~uint32_t{0};

    BoxHierarchy() = default;
    /// The same for any number of threads. Fewer than 2^31 - 1 boxes, none of them empty.
    explicit BoxHierarchy(std::span<const Bounds3> boxes);

    bool empty() const { return nodes_.empty(); }
    /// The root is the first; parents come before their children.
    const std::vector<Node>& nodes() const { return nodes_; }
    /// Item i is box order()[i].
    const std::vector<uint32_t>& order() const { return order_; }
    const Bounds3& bounds() const { return bounds_; }
    size_t memory() const {
        return nodes_.capacity() * sizeof(Node) + order_.capacity() * sizeof(uint32_t);
    }

    /// Best first. bounds(node, index) gives a lower bound on what is wanted for each of the node's
    /// boxes; children at or above limit() are left out; visit(item) is called for the items that
    /// remain.
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
        uint32_t child;
    };
    std::array<Entry, kMostDepth * kWidth> stack;
    if (nodes_.empty()) return;
    stack[0] = {0, 0};
    for (size_t size = 1; size > 0;) {
        const Entry e = stack[--size];
        if (!(e.bound < limit())) continue;
        if (e.child >= kItem) {
            visit(e.child - kItem);
            continue;
        }
        const Node& node = nodes_[e.child];
        const Float8 lower = bounds(node, e.child);
        const size_t base = size;
        for (unsigned below = below8(lower, limit()); below != 0; below &= below - 1) {
            const auto k = static_cast<size_t>(std::countr_zero(below));
            const float bound = lower[k];
            // Farthest at the bottom.
            size_t at = size++;
            for (; at > base && stack[at - 1].bound < bound; --at) stack[at] = stack[at - 1];
            stack[at] = {bound, node.child[k]};
        }
    }
}

}  // namespace covtrace
