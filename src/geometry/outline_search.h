/// The state of one search for outlines beside a segment: bounds for boxes, and what was found.
/// Only for occluder_query.cpp.
#pragma once

#include <array>
#include <cmath>

#include "core/frame.h"
#include "geometry/affine.h"
#include "geometry/box_hierarchy.h"
#include "geometry/fold_edges.h"
#include "geometry/occluder_query.h"

namespace covtrace {

class OutlineSearch {
  public:
    OutlineSearch(Vec3 begin, Vec3 end, const EdgeMeasure& measure, float nearest);

    /// Whether no edge can matter.
    bool is_over() const { return !(lo_ <= hi_); }
    /// Squared width that an edge must stay below to be of interest.
    float limit() const { return limit_; }

    /// Lower bounds on the squared widths of what the boxes of a node hold, in the world.
    Float8 bound_world(const BoxHierarchy::Node& node) const;
    /// An edge of the world that belongs to `body`.
    void meet(const FoldEdge& edge, uint32_t body) { meet(edge, edge.a, edge.b, end_, body); }

    /// The space of the edges that follow.
    void enter(const Affine& world_from_local);
    Vec3 local_end() const { return local_end_; }
    Float8 bound_local(const BoxHierarchy::Node& node) const;
    void meet_local(const FoldEdge& edge, uint32_t body) {
        meet(edge, to_world(edge.a), to_world(edge.b), local_end_, body);
    }

    /// A whole ball of the world: outlined by the circle on which its tangents from end_ touch it.
    void meet_ball(Vec3 center, float radius, uint32_t body);

    /// velocity(body, point).
    template <class Velocity>
    void collect(OutlineEvents& events, const Velocity& velocity);

  private:
    struct Candidate {
        float width2 = kInfinity;
        OutlineEvent event;
        Vec3 point;
        uint32_t body = 0;
    };

    Vec3 to_world(Vec3 p) const {
        return {dot(rows_[0], p) + shift_.x, dot(rows_[1], p) + shift_.y,
                dot(rows_[2], p) + shift_.z};
    }
    /// From middles relative to end_ and half sizes, by axis.
    Float8 bound(const Float8& x, const Float8& y, const Float8& z, const Float8& hx,
                 const Float8& hy, const Float8& hz) const;
    /// `a`, `b`: the edge in the world; `seen_from`: end_ in the edge's space.
    void meet(const FoldEdge& edge, Vec3 a, Vec3 b, Vec3 seen_from, uint32_t body);
    void keep(const Candidate& candidate);

    Vec3 end_, axis_;  ///< unit, from the end to the beginning
    Frame frame_;      ///< about axis_
    EdgeMeasure measure_;
    float lo_ = 1, hi_ = 0;  ///< distances from the end
    float limit_ = 0;
    float widest2_ = 0;
    std::array<Candidate, OutlineEvents::kMost> best_;  ///< by sector of direction

    std::array<Vec3, 3> rows_, absolute_;
    Vec3 shift_, local_end_;

    /// The same numbers in all lanes: end_, axis_, its absolute value, the range and the measure.
    std::array<Float8, 3> wide_end_, wide_axis_, wide_size_;
    Float8 wide_lo_, wide_hi_, wide_a0_, wide_a1_, wide_b_, wide_h0_, wide_h1_, wide_h2_, least_h_;
};

inline Float8 OutlineSearch::bound_world(const BoxHierarchy::Node& node) const {
    const auto &m = node.middle, &h = node.half;
    return bound(m[0] - wide_end_[0], m[1] - wide_end_[1], m[2] - wide_end_[2], h[0], h[1], h[2]);
}

inline Float8 OutlineSearch::bound_local(const BoxHierarchy::Node& node) const {
    std::array<Float8, 3> middle, half;
    for (size_t i = 0; i < 3; ++i) {
        const Vec3 r = rows_[i], a = absolute_[i];
        const int axis = static_cast<int>(i);
        middle[i] = r.x * node.middle[0] + r.y * node.middle[1] + r.z * node.middle[2] +
                    (shift_[axis] - end_[axis]);
        half[i] = a.x * node.half[0] + a.y * node.half[1] + a.z * node.half[2];
    }
    return bound(middle[0], middle[1], middle[2], half[0], half[1], half[2]);
}

inline Float8 OutlineSearch::bound(const Float8& x, const Float8& y, const Float8& z,
                                   const Float8& hx, const Float8& hy, const Float8& hz) const {
    const auto &w = wide_axis_, &s = wide_size_;
    const Float8 along = x * w[0] + y * w[1] + z * w[2];
    const Float8 reach = hx * s[0] + hy * s[1] + hz * s[2];
    // Across the axis: the box lies beyond a plane at right angles to the way to its middle.
    const Float8 px = x - along * w[0], py = y - along * w[1], pz = z - along * w[2];
    const Float8 p2 = px * px + py * py + pz * pz;
    const Float8 inward = hx * abs8(px) + hy * abs8(py) + hz * abs8(pz);
    const Float8 beyond = max8(p2 - inward, Float8{});
    const Float8 r2 = beyond * beyond / (p2 + 1e-30f);
    const Float8 z0 = max8(along - reach, wide_lo_), z1 = min8(along + reach, wide_hi_);
    const Float8 a = wide_a0_ + wide_a1_ * z0, b = wide_a0_ + wide_a1_ * z1;
    const Float8 blur = a * b > 0 ? min8(a * a, b * b) : Float8{};
    const Float8 h = max8(max8(wide_h0_ + z0 * (wide_h1_ + z0 * wide_h2_),
                               wide_h0_ + z1 * (wide_h1_ + z1 * wide_h2_)),
                          least_h_);
    return z0 <= z1 ? (blur + wide_b_ * r2) / h : all8(kInfinity);
}

template <class Velocity>
void OutlineSearch::collect(OutlineEvents& events, const Velocity& velocity) {
    std::sort(best_.begin(), best_.end(),
              [](const Candidate& a, const Candidate& b) { return a.width2 < b.width2; });
    /// Cosine of the angle within which two edges limit the light in the same direction.
    constexpr float kSameDirection = 0.87f;
    for (const Candidate& c : best_) {
        if (c.width2 == kInfinity || c.width2 > limit_) break;
        bool repeats = false;
        for (size_t i = 0; i < events.count; ++i)
            repeats = repeats ||
                      std::abs(dot(events.events[i].direction, c.event.direction)) > kSameDirection;
        if (repeats) continue;
        size_t at = events.count++;
        for (; at > 0 && events.events[at - 1].z < c.event.z; --at)
            events.events[at] = events.events[at - 1];
        OutlineEvent& e = events.events[at];
        e = c.event;
        e.width = std::sqrt(c.width2);
        e.velocity = velocity(c.body, c.point);
    }
}

}  // namespace covtrace
