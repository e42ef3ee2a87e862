#include "geometry/box_hierarchy.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "core/parallel.h"

namespace covtrace {

namespace {

/// Items [begin, end) of the order, for one child of a node.
struct Range {
    uint32_t begin = 0, end = 0;
    uint32_t size() const { return end - begin; }
};

}  // namespace

/// Halves ranges of boxes at the median of their middles along the longest axis, three times per
/// node.
struct BoxHierarchy::Builder {
    BoxHierarchy& h;
    std::span<const Bounds3> boxes;
    static constexpr uint32_t kSerial = 1 << 14;  ///< ranges below are built by one thread each

    /// A range whose nodes are built apart from the rest.
    struct Task {
        Range range;
        uint32_t node = 0;  ///< of the tree above
        size_t child = 0;
        std::vector<Node> nodes;
    };
    std::vector<Task> tasks;

    Bounds3 bounds_of(Range r) const {
        Bounds3 b;
        for (uint32_t i = r.begin; i < r.end; ++i) b.extend(boxes[h.order_[i]]);
        return b;
    }

    uint32_t halve(Range r) const {
        Bounds3 middles;
        for (uint32_t i = r.begin; i < r.end; ++i) middles.extend(boxes[h.order_[i]].center());
        const Vec3 d = middles.diagonal();
        const int axis = d.x >= d.y && d.x >= d.z ? 0 : (d.y >= d.z ? 1 : 2);
        const uint32_t middle = r.begin + r.size() / 2;
        const auto at = [&](uint32_t i) { return h.order_.begin() + static_cast<ptrdiff_t>(i); };
        std::nth_element(at(r.begin), at(middle), at(r.end), [&](uint32_t a, uint32_t b) {
            const float ca = boxes[a].lo[axis] + boxes[a].hi[axis],
                        cb = boxes[b].lo[axis] + boxes[b].hi[axis];
            return ca < cb || (ca == cb && a < b);
        });
        return middle;
    }

    /// Up to eight parts of a range, in order; returns how many.
    size_t split(Range r, std::array<Range, kWidth>& parts) const {
        size_t count = 1;
        parts[0] = r;
        for (int round = 0; round < 3; ++round) {
            const std::array<Range, kWidth> wholes = parts;
            const size_t before = std::exchange(count, 0);
            for (size_t i = 0; i < before; ++i) {
                if (wholes[i].size() < 2) {
                    parts[count++] = wholes[i];
                    continue;
                }
                const uint32_t middle = halve(wholes[i]);
                parts[count++] = {wholes[i].begin, middle};
                parts[count++] = {middle, wholes[i].end};
            }
        }
        return count;
    }

    /// Appends the node of a range to `nodes` and builds what is below it; ranges below kSerial are
    /// left to `tasks` where `apart`.
    uint32_t build(Range r, std::vector<Node>& nodes, bool apart) {
        const auto index = static_cast<uint32_t>(nodes.size());
        nodes.emplace_back();
        std::array<Range, kWidth> parts;
        const size_t count = split(r, parts);
        for (size_t k = 0; k < kWidth; ++k) {
            if (k >= count) {
                nodes[index].child[k] = kNone;
                for (Float8& axis : nodes[index].middle)
                    axis[k] = std::numeric_limits<float>::quiet_NaN();
                continue;
            }
            const Bounds3 b = bounds_of(parts[k]);
            for (int axis = 0; axis < 3; ++axis) {
                const auto a = static_cast<size_t>(axis);
                nodes[index].middle[a][k] = 0.5f * (b.lo[axis] + b.hi[axis]);
                // Rounded up, so that the box holds its items.
                nodes[index].half[a][k] =
                    0.5f * (b.hi[axis] - b.lo[axis]) +
                    2e-7f * std::max(std::abs(b.lo[axis]), std::abs(b.hi[axis]));
            }
            if (parts[k].size() == 1) {
                nodes[index].child[k] = kItem + parts[k].begin;
                continue;
            }
            if (apart && parts[k].size() < kSerial) {
                tasks.push_back({parts[k], index, k, {}});
                continue;
            }
            const uint32_t below = build(parts[k], nodes, apart);  // `nodes` may move meanwhile
            nodes[index].child[k] = below;
        }
        return index;
    }

    void run() {
        h.order_.resize(boxes.size());
        std::iota(h.order_.begin(), h.order_.end(), 0u);
        const Range all{0, static_cast<uint32_t>(boxes.size())};
        h.bounds_ = bounds_of(all);
        build(all, h.nodes_, true);
        parallel_for(static_cast<int64_t>(tasks.size()), [&](int64_t i) {
            Task& t = tasks[static_cast<size_t>(i)];
            build(t.range, t.nodes, false);
        });
        for (Task& t : tasks) {
            const auto first = static_cast<uint32_t>(h.nodes_.size());
            for (Node& n : t.nodes)
                for (size_t k = 0; k < kWidth; ++k)
                    if (n.child[k] < kItem) n.child[k] += first;
            h.nodes_[t.node].child[t.child] = first;
            h.nodes_.insert(h.nodes_.end(), t.nodes.begin(), t.nodes.end());
            t.nodes = {};
        }
        h.nodes_.shrink_to_fit();
    }
};

BoxHierarchy::BoxHierarchy(std::span<const Bounds3> boxes) {
    if (!boxes.empty()) Builder{*this, boxes, {}}.run();
}

}  // namespace covtrace
