#include "shading/light_tree.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "shading/light_weight.h"

namespace covtrace {

namespace {

constexpr int kBuckets = 12;
/// From this depth on nodes are halved by count, so that no trail is longer than its 64 bits.
constexpr int kMostBinnedDepth = 32;
constexpr float kLargestBelowOne = 1 - 0x1p-24f;

float angle_between(Vec3 a, Vec3 b) {
    return std::atan2(length(cross(a, b)), dot(a, b));
}

/// cos(max(0, a - b)) for angles in [0, pi].
float cos_of_excess(float sin_a, float cos_a, float sin_b, float cos_b) {
    return cos_a > cos_b ? 1.0f : cos_a * cos_b + sin_a * sin_b;
}
/// sin(max(0, a - b)).
float sin_of_excess(float sin_a, float cos_a, float sin_b, float cos_b) {
    return cos_a > cos_b ? 0.0f : sin_a * cos_b - cos_a * sin_b;
}

/// Measure of the directions a cone of emitters shines into, Conty and Kulla 2018, section 4.3.
float orientation_measure(const LightBounds& b) {
    const float o = b.theta_o, w = std::min(o + b.theta_e, kPi);
    const float sin_o = std::sin(o), cos_o = std::cos(o);
    return 2 * kPi * (1 - cos_o) +
           kPi / 2 * (2 * w * sin_o - std::cos(o - 2 * w) - 2 * o * sin_o + cos_o);
}

/// Cost of a node: power, directions and size. The squared diagonal keeps lights on a line apart.
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
    // A two-sided light has no preferred side: take the one that keeps the cone narrow.
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

LightTree::LightTree(const std::vector<LightBounds>& lights) : trails_(lights.size(), kNotInTree) {
    std::vector<Item> items;
    for (size_t i = 0; i < lights.size(); ++i)
        if (lights[i].intensity > 0) items.push_back({lights[i], static_cast<uint32_t>(i)});
    if (items.empty()) return;
    nodes_.reserve(2 * items.size() - 1);
    build(items, 0, items.size(), 0, 0);
}

LightTree::Node LightTree::make_node(const LightBounds& b, bool is_leaf, uint32_t link) {
    // A little more than the exact angles, so that rounding can't cut off what a light emits.
    constexpr float kSlack = 2e-3f;
    Node node;
    node.center = b.box.center();
    node.radius_squared = 0.25f * length_squared(b.box.diagonal());
    node.axis = b.axis;
    node.intensity = b.intensity;
    node.cos_o = std::cos(std::min(b.theta_o, kPi));
    node.sin_o = std::sin(std::min(b.theta_o, kPi));
    node.cos_e = std::cos(std::min(b.theta_e + kSlack, kPi));
    node.two_sided = b.two_sided;
    node.is_leaf = is_leaf;
    node.link = link;
    return node;
}

LightBounds LightTree::build(std::vector<Item>& items, size_t begin, size_t end, uint64_t trail,
                             int depth) {
    const size_t index = nodes_.size();
    if (end - begin == 1) {
        const Item& item = items[begin];
        nodes_.push_back(make_node(item.bounds, true, item.light));
        trails_[item.light] = trail;
        return item.bounds;
    }
    Bounds3 centers;
    for (size_t i = begin; i < end; ++i) centers.extend(items[i].bounds.box.center());
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
            LightBounds& b = bounds[static_cast<size_t>(bucket(items[i], axis))];
            b = merge(b, items[i].bounds);
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

    const auto first = items.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last = items.begin() + static_cast<std::ptrdiff_t>(end);
    size_t middle = (begin + end) / 2;
    if (best_axis >= 0) {
        const auto split = std::stable_partition(
            first, last, [&](const Item& item) { return bucket(item, best_axis) <= best_bucket; });
        middle = static_cast<size_t>(split - items.begin());
    } else if (longest > 0) {
        const int axis = extents.x == longest ? 0 : (extents.y == longest ? 1 : 2);
        std::stable_sort(first, last, [axis](const Item& a, const Item& b) {
            return a.bounds.box.center()[axis] < b.bounds.box.center()[axis];
        });
    }

    nodes_.emplace_back();
    const LightBounds left = build(items, begin, middle, trail, depth + 1);
    const auto second = static_cast<uint32_t>(nodes_.size());
    const LightBounds right = build(items, middle, end, trail | uint64_t{1} << depth, depth + 1);
    const LightBounds both = merge(left, right);
    nodes_[index] = make_node(both, false, second);
    return both;
}

float LightTree::Node::importance(Vec3 p, Vec3 n) const {
    const Vec3 offset = p - center;
    const float distance_squared = length_squared(offset);
    // Within the bounds nothing is known about directions.
    if (distance_squared <= radius_squared * 1.0001f)
        return intensity / std::max(radius_squared, 1e-20f);
    const float d = std::sqrt(distance_squared);
    const Vec3 w = offset * (1 / d);
    const float sin_b2 = std::min(1.0f, radius_squared / distance_squared);
    const float sin_b = std::sqrt(sin_b2), cos_b = std::sqrt(1 - sin_b2);

    const float cos_axis = dot(axis, w);
    const float cos_w = std::clamp(two_sided ? std::abs(cos_axis) : cos_axis, -1.0f, 1.0f);
    const float sin_w = safe_sqrt(1 - cos_w * cos_w);
    const float cos_x = cos_of_excess(sin_w, cos_w, sin_o, cos_o);
    const float sin_x = sin_of_excess(sin_w, cos_w, sin_o, cos_o);
    const float cos_emission = cos_of_excess(sin_x, cos_x, sin_b, cos_b);
    if (cos_emission <= cos_e) return 0;

    float received = 1;
    if (!(n == Vec3{})) {
        const float cos_i = std::clamp(-dot(w, n), -1.0f, 1.0f);
        const float sin_i = safe_sqrt(1 - cos_i * cos_i);
        received = side_weight(cos_of_excess(sin_i, cos_i, sin_b, cos_b));
    }
    return intensity * std::max(cos_emission, 1e-3f) * received /
           std::max(distance_squared, 1e-20f);
}

float LightTree::irradiance(Vec3 p, Vec3 n) const {
    if (nodes_.empty()) return 0;
    const Node& root = nodes_.front();
    if (root.is_leaf) return root.importance(p, n);
    // One level down is a much better bound where lights are scattered.
    return nodes_[1].importance(p, n) + nodes_[root.link].importance(p, n);
}

std::optional<LightTree::Choice> LightTree::sample(Vec3 p, Vec3 n, float u) const {
    if (nodes_.empty()) return std::nullopt;
    size_t index = 0;
    float probability = 1;
    if (nodes_.front().is_leaf && !(nodes_.front().importance(p, n) > 0)) return std::nullopt;
    while (!nodes_[index].is_leaf) {
        const size_t second = nodes_[index].link;
        const float a = nodes_[index + 1].importance(p, n), b = nodes_[second].importance(p, n);
        if (!(a + b > 0)) return std::nullopt;
        const float share = a / (a + b);
        if (u < share) {
            u = std::min(u / share, kLargestBelowOne);
            probability *= share;
            ++index;
        } else {
            const float other = b / (a + b);
            u = std::min((u - share) / (1 - share), kLargestBelowOne);
            probability *= other;
            index = second;
        }
    }
    if (!(probability > 0)) return std::nullopt;
    return Choice{static_cast<int>(nodes_[index].link), probability};
}

float LightTree::probability(Vec3 p, Vec3 n, int light) const {
    uint64_t trail = trails_[static_cast<size_t>(light)];
    if (trail == kNotInTree) return 0;
    size_t index = 0;
    float probability =
        nodes_.front().is_leaf && !(nodes_.front().importance(p, n) > 0) ? 0.0f : 1.0f;
    while (!nodes_[index].is_leaf) {
        const size_t second = nodes_[index].link;
        const float a = nodes_[index + 1].importance(p, n), b = nodes_[second].importance(p, n);
        const bool go_right = trail & 1;
        if (!((go_right ? b : a) > 0)) return 0;
        probability *= (go_right ? b : a) / (a + b);
        index = go_right ? second : index + 1;
        trail >>= 1;
    }
    return probability;
}

}  // namespace covtrace
