#include "occluders/box_hierarchy.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/parallel.h"

namespace covtrace {

namespace {

/// Boxes [begin, end) of the builder's order.
struct Range {
    uint32_t begin = 0, end = 0;
    uint32_t size() const { return end - begin; }
};

/// The box around several boxes, and how many they are.
struct Extent {
    Float8 least = all8(kInfinity);  ///< lower ends, and upper ones with the sign turned, by axis
    uint32_t count = 0;

    void add(const Extent& e) {
        least = min8(least, e.least);
        count += e.count;
    }
    Bounds3 bounds() const {
        return {{least[0], least[1], least[2]}, {-least[3], -least[4], -least[5]}};
    }
};

/// Width of a usual search, as a part of the size of all boxes: with it a search enters boxes
/// without any area, too.
constexpr float kMargin = 0.01f;

}  // namespace

/// Builds the hierarchy by the surface area heuristic: ranges are split where the sum over both
/// parts, of the chance that a search enters one times its number of items, is least. The boxes'
/// middles are sorted into bins along each axis.
struct BoxHierarchy::Builder {
    BoxHierarchy& h;
    std::span<const Bounds3> boxes;
    uint32_t per_item;
    const std::function<bool()>& is_cancelled;
    bool by_many_threads;
    float margin = 0;
    std::atomic<bool> was_cancelled = false;
    static constexpr uint32_t kSerial = 1 << 14;  ///< ranges below are built by one thread each
    static constexpr int kBins = 16;
    /// smaller ranges are built by one thread each
    static constexpr int kLopsided = 20;

    struct Part {
        Range range;
        Extent extent;
        float chance = 0;
    };

    /// A range whose nodes are built apart from the rest.
    struct Task {
        Part part;
        int depth = 0;
        uint32_t node = 0;  ///< parent in the tree above
        size_t child = 0;
        std::vector<Node> nodes;
    };
    std::vector<Task> tasks{};

    Extent extent_of(uint32_t box) const {
        const Bounds3& b = boxes[box];
        return {Float8{b.lo.x, b.lo.y, b.lo.z, -b.hi.x, -b.hi.y, -b.hi.z, 0, 0}, 1};
    }
    /// Half of a box's middle, by which boxes are sorted: differences of these stay finite.
    Vec3 key_of(uint32_t box) const { return boxes[box].lo * 0.25f + boxes[box].hi * 0.25f; }

    /// Chance that a search enters a box, up to a common factor: half its surface, with a margin.
    float chance_of(const Extent& e) const {
        const Vec3 d = e.bounds().diagonal() + Vec3{margin, margin, margin};
        return d.x * d.y + d.y * d.z + d.z * d.x;
    }
    Part part_of(Range r) const {
        Part p{r, {}, 0};
        for (uint32_t i = r.begin; i < r.end; ++i) p.extent.add(extent_of(h.order_[i]));
        p.chance = chance_of(p.extent);
        return p;
    }
    uint32_t items_in(uint32_t count) const { return (count + per_item - 1) / per_item; }

    std::array<Part, 2> halve(const Part& p) const {
        const uint32_t middle = p.range.begin + p.range.size() / 2;
        return {part_of({p.range.begin, middle}), part_of({middle, p.range.end})};
    }

    std::array<Part, 2> split(const Part& p, int depth) const {
        if (depth >= kLopsided) return halve(p);
        const Range r = p.range;
        Bounds3 keys;
        for (uint32_t i = r.begin; i < r.end; ++i) keys.extend(key_of(h.order_[i]));
        const int bins = r.size() < 32 ? kBins / 2 : kBins;
        Vec3 scale;
        for (int k = 0; k < 3; ++k)
            if (keys.hi[k] - keys.lo[k] > 1e-36f)
                scale[k] = 0.9999f * static_cast<float>(bins) / (keys.hi[k] - keys.lo[k]);
        const auto bins_of = [&](uint32_t box) { return (key_of(box) - keys.lo) * scale; };
        // By way of int: the way to size_t asks whether the number needs its last bit, which takes
        // a tenth of the whole build.
        const auto bin_at = [](float at) { return static_cast<size_t>(static_cast<int>(at)); };
        std::array<std::array<Extent, kBins>, 3> of_bin;
        for (uint32_t i = r.begin; i < r.end; ++i) {
            const Extent e = extent_of(h.order_[i]);
            const Vec3 at = bins_of(h.order_[i]);
            for (int k = 0; k < 3; ++k) of_bin[size_t(k)][bin_at(at[k])].add(e);
        }

        float best = kInfinity;
        int best_key = 0, best_bin = 0;
        Part best_left, best_right;
        for (int k = 0; k < 3; ++k) {
            if (!(scale[k] > 0)) continue;
            const auto& of_key = of_bin[size_t(k)];
            std::array<Extent, kBins> right;
            Extent sum;
            for (int b = bins; b-- > 1;) {
                sum.add(of_key[size_t(b)]);
                right[size_t(b)] = sum;
            }
            Extent left;
            for (int b = 1; b < bins; ++b) {
                left.add(of_key[size_t(b - 1)]);
                const Extent& other = right[size_t(b)];
                if (left.count == 0 || other.count == 0) continue;
                const float cl = chance_of(left), cr = chance_of(other);
                const float cost = cl * static_cast<float>(items_in(left.count)) +
                                   cr * static_cast<float>(items_in(other.count));
                if (!(cost < best)) continue;
                best = cost;
                best_key = k;
                best_bin = b;
                best_left = {{}, left, cl};
                best_right = {{}, other, cr};
            }
        }
        if (!(best < kInfinity)) return halve(p);
        const auto at = [&](uint32_t i) { return h.order_.begin() + static_cast<ptrdiff_t>(i); };
        std::partition(at(r.begin), at(r.end), [&](uint32_t box) {
            return static_cast<int>(bins_of(box)[best_key]) < best_bin;
        });
        const uint32_t middle = r.begin + best_left.extent.count;
        best_left.range = {r.begin, middle};
        best_right.range = {middle, r.end};
        return {best_left, best_right};
    }

    /// Splits a range into up to eight parts, in order; returns how many.
    size_t split_wide(const Part& whole, int depth, std::array<Part, kWidth>& parts) const {
        size_t count = 1;
        parts[0] = whole;
        while (count < kWidth) {
            size_t widest = count;
            for (size_t i = 0; i < count; ++i)
                if (parts[i].range.size() > per_item &&
                    (widest == count || parts[i].chance > parts[widest].chance))
                    widest = i;
            if (widest == count) break;
            const auto [left, right] = split(parts[widest], depth);
            std::move_backward(parts.begin() + static_cast<ptrdiff_t>(widest) + 1,
                               parts.begin() + static_cast<ptrdiff_t>(count),
                               parts.begin() + static_cast<ptrdiff_t>(count) + 1);
            parts[widest] = left;
            parts[widest + 1] = right;
            ++count;
        }
        return count;
    }

    /// Appends the node of a range to `nodes` and builds what is below it; ranges below kSerial are
    /// left to `tasks` where `apart`. Items are numbered by the first of their boxes.
    uint32_t build(const Part& part, int depth, std::vector<Node>& nodes, bool apart) {
        const auto index = static_cast<uint32_t>(nodes.size());
        nodes.emplace_back();
        if (is_cancelled && part.range.size() >= kSerial / kWidth && is_cancelled())
            was_cancelled = true;
        if (was_cancelled) return index;
        std::array<Part, kWidth> parts;
        const size_t count = split_wide(part, depth, parts);
        for (size_t k = 0; k < kWidth; ++k) {
            Node& node = nodes[index];
            if (k >= count) {
                node.child[k] = kNone;
                node.middle.x[k] = node.middle.y[k] = node.middle.z[k] =
                    std::numeric_limits<float>::quiet_NaN();
                continue;
            }
            const Bounds3 b = parts[k].extent.bounds();
            const auto place = [k](float lo, float hi, Float8& middle, Float8& half) {
                middle[k] = 0.5f * (lo + hi);
                // Half sizes are rounded up, so that the rounded box holds the exact one.
                half[k] = 0.5f * (hi - lo) + 2e-7f * std::max(std::abs(lo), std::abs(hi));
            };
            place(b.lo.x, b.hi.x, node.middle.x, node.half.x);
            place(b.lo.y, b.hi.y, node.middle.y, node.half.y);
            place(b.lo.z, b.hi.z, node.middle.z, node.half.z);
            const Range range = parts[k].range;
            if (range.size() <= per_item) {
                node.child[k] = kItem + range.begin;
                continue;
            }
            if (apart && range.size() < kSerial) {
                tasks.push_back({parts[k], depth + 1, index, k, {}});
                continue;
            }
            const uint32_t below = build(parts[k], depth + 1, nodes, apart);
            nodes[index].child[k] = below;  // `nodes` may have moved meanwhile
        }
        return index;
    }

    void number_items() {
        std::vector<bool> starts(boxes.size(), false);
        for (const Node& n : h.nodes_)
            for (uint32_t c : n.child)
                if (c != kNone && c >= kItem) starts[c - kItem] = true;
        std::vector<uint32_t> number(boxes.size());
        h.first_.clear();
        for (uint32_t i = 0; i < boxes.size(); ++i) {
            if (starts[i]) h.first_.push_back(i);
            number[i] = static_cast<uint32_t>(h.first_.size()) - 1;
        }
        h.first_.push_back(static_cast<uint32_t>(boxes.size()));
        for (Node& n : h.nodes_)
            for (uint32_t& c : n.child)
                if (c != kNone && c >= kItem) c = kItem + number[c - kItem];
    }

    void run() {
        h.order_.resize(boxes.size());
        std::iota(h.order_.begin(), h.order_.end(), 0u);
        const Part all = part_of({0, static_cast<uint32_t>(boxes.size())});
        h.bounds_ = all.extent.bounds();
        margin = kMargin * length(h.bounds_.diagonal());
        build(all, 0, h.nodes_, by_many_threads);
        if (by_many_threads)
            parallel_for(static_cast<int64_t>(tasks.size()), [&](int64_t i) {
                Task& t = tasks[static_cast<size_t>(i)];
                build(t.part, t.depth, t.nodes, false);
            });
        if (was_cancelled) {
            h = BoxHierarchy();
            return;
        }
        for (Task& t : tasks) {
            const auto first = static_cast<uint32_t>(h.nodes_.size());
            for (Node& n : t.nodes)
                for (uint32_t& c : n.child)
                    if (c < kItem) c += first;
            h.nodes_[t.node].child[t.child] = first;
            h.nodes_.insert(h.nodes_.end(), t.nodes.begin(), t.nodes.end());
            t.nodes = std::vector<Node>();
        }
        h.nodes_.shrink_to_fit();
        number_items();
    }
};

BoxHierarchy::BoxHierarchy(std::span<const Bounds3> boxes, uint32_t per_item,
                           const std::function<bool()>& cancelled) {
    if (!boxes.empty())
        Builder{*this, boxes, per_item, cancelled, boxes.size() >= Builder::kSerial}.run();
}

BoxHierarchy BoxHierarchy::by_one_thread(std::span<const Bounds3> boxes, uint32_t per_item) {
    const std::function<bool()> never;
    BoxHierarchy h;
    if (!boxes.empty()) Builder{h, boxes, per_item, never, false}.run();
    return h;
}

}  // namespace covtrace
