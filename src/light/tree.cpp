#include "light/tree.h"

#include <algorithm>
#include <cmath>

#include "core/hash.h"
#include "light/weight.h"

namespace covtrace {

namespace {

/// The value cos(max(0, a - b)) for angles a, b in [0, pi].
inline float cos_of_excess(float sin_a, float cos_a, float sin_b, float cos_b) {
    const float difference = cos_a * cos_b + sin_a * sin_b;
    return cos_a > cos_b ? 1.0f : difference;
}
/// The value sin(max(0, a - b)) for angles a, b in [0, pi].
inline float sin_of_excess(float sin_a, float cos_a, float sin_b, float cos_b) {
    const float difference = sin_a * cos_b - cos_a * sin_b;
    return cos_a > cos_b ? 0.0f : difference;
}

/// Mean cosine between a surface's normal and the part above the horizon of a cone of directions
/// with half angle b, at the angle i to the normal: the cosine of i, and for cones that the horizon
/// cuts about that of the part that is left.
inline float mean_cosine(float cos_i, float sin_b) {
    const float above = std::max(0.0f, cos_i + sin_b);
    return cos_i >= sin_b ? cos_i : above * above / std::max(4 * sin_b, 1e-20f);  // of points: 0
}

float sum(const std::array<float, 4>& v) {
    return (v[0] + v[1]) + (v[2] + v[3]);
}

}  // namespace

/// Importance of all children at once. It has no branches, so that the loop becomes vector
/// instructions.
template <LightTree::Estimate kEstimate>
LightTree::Lanes LightTree::Node::importance(Vec3 p, Vec3 n) const {
    const bool is_volume = n == Vec3{};
    Lanes result;
    for (size_t i = 0; i < kWidth; ++i) {
        const float dx = p.x - center_x[i], dy = p.y - center_y[i], dz = p.z - center_z[i];
        const float distance_squared = dx * dx + dy * dy + dz * dz;
        const float at_least = std::max(distance_squared, 1e-20f);
        const float scale = 1 / std::sqrt(at_least);
        const float wx = dx * scale, wy = dy * scale, wz = dz * scale;
        const float sin_b2 = std::min(1.0f, radius_squared[i] / at_least);
        const float sin_b = std::sqrt(sin_b2), cos_b = std::sqrt(1 - sin_b2);

        const float cos_axis = axis_x[i] * wx + axis_y[i] * wy + axis_z[i] * wz;
        const float cos_side = two_sided[i] ? std::abs(cos_axis) : cos_axis;
        const float cos_w = std::max(-1.0f, std::min(cos_side, 1.0f));
        const float sin_w = std::sqrt(1 - cos_w * cos_w);
        const float cos_x = cos_of_excess(sin_w, cos_w, sin_o[i], cos_o[i]);
        const float sin_x = sin_of_excess(sin_w, cos_w, sin_o[i], cos_o[i]);
        const float cos_emission = cos_of_excess(sin_x, cos_x, sin_b, cos_b);

        const float cos_i = std::max(-1.0f, std::min(-(wx * n.x + wy * n.y + wz * n.z), 1.0f));
        const float sin_i = std::sqrt(1 - cos_i * cos_i);
        const float received = kEstimate == Estimate::mean
                                   ? mean_cosine(cos_i, sin_b)
                                   : side_weight(cos_of_excess(sin_i, cos_i, sin_b, cos_b));
        const float outside = cos_emission > cos_e[i]
                                  ? intensity[i] * std::max(cos_emission, 1e-3f) *
                                        (is_volume ? 1.0f : received) / at_least
                                  : 0.0f;
        // A point within the bounds knows nothing of the directions to the lights.
        const float inside = intensity[i] / std::max(radius_squared[i], 1e-20f);
        result[i] = distance_squared <= radius_squared[i] * 1.0001f ? inside : outside;
    }
    return result;
}

LightTree::Lanes LightTree::Node::importance_beside(Vec3 origin, Vec3 direction,
                                                    float length) const {
    Lanes result{};
    for (size_t i = 0; i < kWidth; ++i) {
        if (!(intensity[i] > 0)) continue;
        const Vec3 to_center = center(i) - origin;
        const float along = dot(to_center, direction);
        const float away = std::sqrt(
            std::max({length_squared(to_center - along * direction), radius_squared[i], 1e-20f}));
        const float angle = std::atan((length - along) / away) + std::atan(along / away);
        result[i] = intensity[i] * angle / away;
    }
    return result;
}

float LightTree::irradiance(Vec3 p, Vec3 n) const {
    // The root's children are summed: where the lights are scattered, this is a much better
    // estimate than one bound of all of them.
    return nodes_.empty() ? 0.0f : sum(nodes_.front().importance<Estimate::mean>(p, n));
}

LightTree::Lanes LightTree::weights(uint32_t node, Vec3 p, Vec3 n, Factors factors) const {
    Lanes w = nodes_[node].importance<Estimate::bound>(p, n);
    if (const size_t first = kWidth * node; first < factors.size())
        for (size_t i = 0; i < kWidth; ++i) w[i] *= factors[first + i];
    return w;
}

size_t LightTree::choose(const Lanes& weights, float total, float& u) {
    // The last child of any weight takes the probability that rounding leaves over.
    float rest = u * total;
    size_t chosen = 0;
    for (size_t i = 0; i < kWidth; ++i) {
        if (!(weights[i] > 0)) continue;
        chosen = i;
        if (rest < weights[i]) break;
        rest -= weights[i];
    }
    u = std::min(rest / weights[chosen], kLargestBelowOne);
    return chosen;
}

std::optional<LightTree::Choice> LightTree::sample(Vec3 p, Vec3 n, float u, Factors factors) const {
    if (nodes_.empty()) return std::nullopt;
    float probability = 1;
    uint32_t link = 0;
    while (!(link & kLeaf)) {
        const Lanes w = weights(link, p, n, factors);
        const float total = sum(w);
        if (!(total > 0)) return std::nullopt;
        const size_t chosen = choose(w, total, u);
        probability *= w[chosen] / total;
        link = nodes_[link].link[chosen];
    }
    if (!(probability > 0)) return std::nullopt;
    return Choice{static_cast<int>(link & ~kLeaf), probability};
}

std::optional<LightTree::Ball> LightTree::choose_beside(Vec3 origin, Vec3 direction, float length,
                                                        float& u) const {
    if (nodes_.empty()) return std::nullopt;
    for (uint32_t link = 0;;) {
        const Node& node = nodes_[link];
        const Lanes w = node.importance_beside(origin, direction, length);
        const float total = sum(w);
        if (!(total > 0)) return std::nullopt;
        const size_t chosen = choose(w, total, u);
        link = node.link[chosen];
        if (link & kLeaf) return Ball{node.center(chosen), std::sqrt(node.radius_squared[chosen])};
    }
}

float LightTree::probability(Vec3 p, Vec3 n, int light, Factors factors) const {
    uint64_t trail = trails_[static_cast<size_t>(light)];
    if (trail == kNotInTree) return 0;
    float probability = 1;
    for (uint32_t link = 0; !(link & kLeaf); trail >>= 2) {
        const Lanes w = weights(link, p, n, factors);
        const float own = w[trail & 3];
        if (!(own > 0)) return 0;
        probability *= own / sum(w);
        link = nodes_[link].link[trail & 3];
    }
    return probability;
}

std::optional<LightTree::Choice> LightTree::explore(Vec3 p, Vec3 n, float u,
                                                    std::vector<Step>& way) const {
    way.clear();
    if (nodes_.empty()) return std::nullopt;
    float probability = 1;
    uint32_t link = 0;
    while (!(link & kLeaf)) {
        const Lanes importance = weights(link, p, n, {});
        const float total = sum(importance);
        if (!(total > 0)) return std::nullopt;
        const auto lit = static_cast<float>(
            std::count_if(importance.begin(), importance.end(), [](float x) { return x > 0; }));
        Lanes tried{};
        for (size_t i = 0; i < kWidth; ++i)
            if (importance[i] > 0) tried[i] = 0.5f * importance[i] / total + 0.5f / lit;
        const size_t chosen = choose(tried, sum(tried), u);
        way.push_back({static_cast<uint32_t>(kWidth * link + chosen), importance[chosen],
                       importance[chosen] / total, tried[chosen] / sum(tried)});
        probability *= way.back().tried;
        link = nodes_[link].link[chosen];
    }
    return Choice{static_cast<int>(link & ~kLeaf), probability};
}

}  // namespace covtrace
