/// The light tree's construction; a light is drawn from it in tree.cpp.
#include <algorithm>
#include <array>
#include <cmath>

#include "light/tree.h"

namespace covtrace {

namespace {

constexpr int kBuckets = 12;
/// Depth from which on nodes are halved by count, so that no leaf is deeper than 64.
constexpr int kMostBinnedDepth = 32;

float angle_between(Vec3 a, Vec3 b) {
    return std::atan2(length(cross(a, b)), dot(a, b));
}

/// Measure of the directions that a cone of emitters shines into (Conty Estevez and Kulla 2018,
/// section 4.3).
float orientation_measure(const LightBounds& b) {
    const float o = b.theta_o, w = std::min(o + b.theta_e, kPi);
    const float sin_o = std::sin(o), cos_o = std::cos(o);
    return 2 * kPi * (1 - cos_o) +
           kPi / 2 * (2 * w * sin_o - std::cos(o - 2 * w) - 2 * o * sin_o + cos_o);
}

/// Cost of a node from its power, directions and size. The squared diagonal keeps lights on a line
/// apart.
float cost(const LightBounds& b) {
    if (!(b.intensity > 0)) return 0;
    const Vec3 d = b.box.diagonal();
    const float size = 2 * (d.x * d.y + d.y * d.z + d.z * d.x) + dot(d, d);
    return b.intensity * orientation_measure(b) * size;
}

}  // namespace

LightBounds merge(const LightBounds& a, const LightBounds& b) {
    if (!(a.intensity > 0)) return b;
    if (!(b.intensity > 0)) return a;
    LightBounds m;
    m.box = a.box;
    m.box.extend(b.box);
    m.intensity = a.intensity + b.intensity;
    m.two_sided = a.two_sided || b.two_sided;
    m.theta_e = std::max(a.theta_e, b.theta_e);
    // The axis of a two-sided light may be turned: the side is taken that keeps the cone narrow.
    const Vec3 b_axis = b.two_sided && dot(a.axis, b.axis) < 0 ? -b.axis : b.axis;
    const float between = angle_between(a.axis, b_axis);
    m.axis = a.axis;
    m.theta_o = a.theta_o;
    if (std::min(between + b.theta_o, kPi) <= a.theta_o) return m;
    if (std::min(between + a.theta_o, kPi) <= b.theta_o) {
        m.axis = b_axis;
        m.theta_o = b.theta_o;
        return m;
    }
    m.theta_o = (a.theta_o + between + b.theta_o) / 2;
    const Vec3 sideways = b_axis - a.axis * dot(a.axis, b_axis);
    if (m.theta_o >= kPi || !(length(sideways) > 1e-6f)) {
        if (between > kPi / 2) m.theta_o = kPi;
        return m;
    }
    const float turn = m.theta_o - a.theta_o;
    m.axis = normalize(a.axis * std::cos(turn) + normalize(sideways) * std::sin(turn));
    return m;
}

/// Builds a binary tree by the cost of its nodes, then makes one level of each two.
class LightTree::Builder {
  public:
    Builder(LightTree& tree, const std::vector<LightBounds>& lights) : tree_(tree) {
        for (size_t i = 0; i < lights.size(); ++i)
            if (lights[i].intensity > 0) items_.push_back({lights[i], static_cast<uint32_t>(i)});
    }
    void run();

  private:
    struct Item {
        LightBounds bounds;
        uint32_t light = 0;
    };
    struct Pair {
        LightBounds bounds;
        bool is_leaf = true;
        uint32_t link = 0;  ///< a leaf's light, or the second child; the first child comes next
    };
    uint32_t split(size_t begin, size_t end, int depth);
    /// A node whose children are still to be set, from a pair of the binary tree.
    struct Unset {
        uint32_t pair = 0, node = 0;
        uint64_t trail = 0;
        int shift = 0;
    };
    void widen(const Unset& unset);
    static void set_child(Node& node, size_t i, const LightBounds& bounds);

    LightTree& tree_;
    std::vector<Item> items_;
    std::vector<Pair> pairs_;
    std::vector<Unset> unset_;  ///< in the order of their nodes
};

uint32_t LightTree::Builder::split(size_t begin, size_t end, int depth) {
    const auto index = static_cast<uint32_t>(pairs_.size());
    if (end - begin == 1) {
        pairs_.push_back({items_[begin].bounds, true, items_[begin].light});
        return index;
    }

    Bounds3 centers;
    for (size_t i = begin; i < end; ++i) centers.extend(items_[i].bounds.box.center());
    const auto bucket = [&centers](const Item& item, int axis) {
        const float extent = centers.hi[axis] - centers.lo[axis];
        const float f = (item.bounds.box.center()[axis] - centers.lo[axis]) / extent;
        return std::clamp(static_cast<int>(kBuckets * f), 0, kBuckets - 1);
    };

    float best_cost = kInfinity;
    int best_axis = -1, best_bucket = -1;
    const Vec3 extents = centers.diagonal();
    const float longest = std::max(extents.x, std::max(extents.y, extents.z));
    for (int axis = 0; axis < 3 && depth < kMostBinnedDepth; ++axis) {
        if (!(extents[axis] > 0)) continue;
        std::array<LightBounds, kBuckets> bounds;
        for (size_t i = begin; i < end; ++i) {
            LightBounds& b = bounds[static_cast<size_t>(bucket(items_[i], axis))];
            b = merge(b, items_[i].bounds);
        }
        std::array<LightBounds, kBuckets> above;
        for (size_t b = kBuckets - 1; b > 0; --b)
            above[b - 1] = merge(b == kBuckets - 1 ? LightBounds{} : above[b], bounds[b]);
        LightBounds below;
        for (size_t b = 0; b + 1 < kBuckets; ++b) {
            below = merge(below, bounds[b]);
            if (!(below.intensity > 0) || !(above[b].intensity > 0)) continue;
            const float c = (cost(below) + cost(above[b])) * longest / extents[axis];
            if (c < best_cost) {
                best_cost = c;
                best_axis = axis;
                best_bucket = static_cast<int>(b);
            }
        }
    }

    const auto first = items_.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last = items_.begin() + static_cast<std::ptrdiff_t>(end);
    size_t middle = (begin + end) / 2;
    if (best_axis >= 0) {
        const auto border = std::stable_partition(
            first, last, [&](const Item& item) { return bucket(item, best_axis) <= best_bucket; });
        middle = static_cast<size_t>(border - items_.begin());
    } else if (longest > 0) {
        const int axis = extents.x == longest ? 0 : (extents.y == longest ? 1 : 2);
        std::stable_sort(first, last, [axis](const Item& a, const Item& b) {
            return a.bounds.box.center()[axis] < b.bounds.box.center()[axis];
        });
    }

    pairs_.emplace_back();
    split(begin, middle, depth + 1);
    const uint32_t second = split(middle, end, depth + 1);
    pairs_[index] = {merge(pairs_[index + 1].bounds, pairs_[second].bounds), false, second};
    return index;
}

void LightTree::Builder::widen(const Unset& unset) {
    // All pairs of a level are opened in turn: two levels fill a node, so that a wide tree is at
    // most half as deep. Room that leaves have spared goes to the levels below.
    std::array<uint32_t, kWidth> child{unset.pair};
    size_t count = 1;
    const auto open = [&](size_t i) {
        const Pair& p = pairs_[child[i]];
        if (p.is_leaf || count == kWidth) return;
        child[count++] = p.link;
        ++child[i];
    };
    for (size_t round = 0; round < kWidth - 1; ++round)
        for (size_t i = 0, known = count; i < known; ++i) open(i);
    for (size_t i = 0; i < count; ++i) {
        const Pair& p = pairs_[child[i]];
        const uint64_t below = unset.trail | uint64_t{i} << unset.shift;
        set_child(tree_.nodes_[unset.node], i, p.bounds);
        if (p.is_leaf) {
            tree_.nodes_[unset.node].link[i] = kLeaf | p.link;
            tree_.trails_[p.link] = below;
            continue;
        }
        const auto next = static_cast<uint32_t>(tree_.nodes_.size());
        tree_.nodes_[unset.node].link[i] = next;
        tree_.nodes_.emplace_back();
        unset_.push_back({child[i], next, below, unset.shift + 2});
    }
}

void LightTree::Builder::set_child(Node& node, size_t i, const LightBounds& b) {
    // The cones are a little wider than the exact angles, so that rounding can't cut off what a
    // light emits.
    constexpr float kSlack = 2e-3f;
    const Vec3 center = b.box.center();
    node.center_x[i] = center.x;
    node.center_y[i] = center.y;
    node.center_z[i] = center.z;
    node.radius_squared[i] = 0.25f * length_squared(b.box.diagonal());
    node.axis_x[i] = b.axis.x;
    node.axis_y[i] = b.axis.y;
    node.axis_z[i] = b.axis.z;
    node.cos_o[i] = std::cos(std::min(b.theta_o, kPi));
    node.sin_o[i] = std::sin(std::min(b.theta_o, kPi));
    node.cos_e[i] = std::cos(std::min(b.theta_e + kSlack, kPi));
    node.intensity[i] = b.intensity;
    node.two_sided[i] = b.two_sided;
}

void LightTree::Builder::run() {
    if (items_.empty()) return;
    pairs_.reserve(2 * items_.size() - 1);
    split(0, items_.size(), 0);
    // Level by level, so that the nodes nearest to the root come first
    tree_.nodes_.emplace_back();
    unset_.push_back({});
    for (size_t i = 0; i < unset_.size(); ++i) widen(Unset(unset_[i]));
}

LightTree::LightTree(const std::vector<LightBounds>& lights) : trails_(lights.size(), kNotInTree) {
    Builder(*this, lights).run();
}

}  // namespace covtrace
