/// The state of one search for outlines beside a segment: bounds for boxes, and what was found.
/// Only for occluder_query.cpp.
#pragma once

#include <array>
#include <cmath>

#include "geometry/affine.h"
#include "geometry/blind_cones.h"
#include "geometry/edge_block.h"
#include "geometry/occluder_query.h"

namespace covtrace {

class OutlineSearch {
  public:
    OutlineSearch(Vec3 begin, Vec3 end, const EdgeMeasure& measure, float nearest);

    /// Whether no edge can matter.
    bool is_over() const { return !(lo_ <= hi_); }
    /// Squared width that an edge must stay below to be of interest.
    float limit() const { return limit_; }

    /// Lower bounds on the squared widths of what the boxes of a node hold, in the world; infinity
    /// where `cones` say that nothing there is an outline.
    Float8 bound_world(const BoxHierarchy::Node& node) const;
    Float8 bound_world(const BoxHierarchy::Node& node, const BlindCones& cones) const;
    /// Edges of the world that belong to `body`.
    void meet_world(const EdgeBlock& edges, uint32_t body);

    /// The space of the edges that follow.
    void enter(const Affine& world_from_local);
    Float8 bound_local(const BoxHierarchy::Node& node, const BlindCones& cones) const;
    void meet_local(const EdgeBlock& edges, uint32_t body);

    /// A whole ball of the world: outlined by the circle on which its tangents from end_ touch it.
    void meet_ball(Vec3 center, float radius, uint32_t body);

    bool has_found() const { return has_found_; }
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
    Float8 bound(const Vec3x8& middle, const Vec3x8& half) const;
    /// Over [z0, z1]: of the measure's numerator without the distance, and of its denominator.
    Float8 least_blur2(const Float8& z0, const Float8& z1) const;
    Float8 most_weight(const Float8& z0, const Float8& z1) const;
    /// Where an edge may be narrow enough. `from`, `along`: in the world, from end_.
    auto may_matter(const Vec3x8& from, const Vec3x8& along) const;
    /// `a`, `b`: the edge in the world; `seen_from`: end_ in the edge's space.
    void meet(const FoldEdge& edge, Vec3 a, Vec3 b, Vec3 seen_from, uint32_t body);
    void keep(const Candidate& candidate);

    Vec3 end_, axis_;  ///< unit, from the end to the beginning
    EdgeMeasure measure_;
    float lo_ = 1, hi_ = 0;  ///< distances from the end
    float limit_ = 0;
    float widest2_ = 0;
    bool has_found_ = false;
    std::array<Candidate, OutlineEvents::kMost> best_;  ///< by sector of direction

    std::array<Vec3, 3> rows_;
    Vec3 shift_, local_end_;

    /// The same numbers in all lanes: end_, axis_, its absolute value, the range and the measure.
    Vec3x8 wide_end_, wide_axis_, wide_size_;
    Float8 wide_lo_, wide_hi_, wide_a0_, wide_a1_, wide_b_, wide_h0_, wide_h1_, wide_h2_, least_h_;
    /// Where the blur is least: 0 in all lanes where it is the same everywhere.
    Float8 wide_sharp_;
};

inline Float8 OutlineSearch::bound_world(const BoxHierarchy::Node& node) const {
    return bound(node.middle - wide_end_, node.half);
}

inline Float8 OutlineSearch::bound_world(const BoxHierarchy::Node& node,
                                         const BlindCones& cones) const {
    const Vec3x8 middle = node.middle - wide_end_;
    return cones.hide(middle) ? all8(kInfinity) : bound(middle, node.half);
}

inline Float8 OutlineSearch::bound(const Vec3x8& middle, const Vec3x8& half) const {
    const Float8 along = dot8(middle, wide_axis_), reach = dot8(half, wide_size_);
    const Float8 z0 = max8(along - reach, wide_lo_), z1 = min8(along + reach, wide_hi_);
    // Across the axis: the box lies beyond a plane at right angles to the way to its middle.
    const Vec3x8 p = less_product8(wide_axis_, along, middle);
    const Float8 p2 = dot8(p, p);
    const Float8 beyond = max8(p2 - dot8(half, abs8(p)), Float8{});
    const Float8 r2 = beyond * beyond / (p2 + 1e-30f);
    const Float8 width2 = add_product8(wide_b_, r2, least_blur2(z0, z1)) / most_weight(z0, z1);
    return z0 <= z1 ? width2 : all8(kInfinity);
}

inline Float8 OutlineSearch::least_blur2(const Float8& z0, const Float8& z1) const {
    const Float8 sharpest = min8(max8(wide_sharp_, z0), z1);
    const Float8 blur = add_product8(wide_a1_, sharpest, wide_a0_);
    return blur * blur;
}

inline Float8 OutlineSearch::most_weight(const Float8& z0, const Float8& z1) const {
    const Float8 h0 = add_product8(add_product8(wide_h2_, z0, wide_h1_), z0, wide_h0_);
    const Float8 h1 = add_product8(add_product8(wide_h2_, z1, wide_h1_), z1, wide_h0_);
    return max8(max8(h0, h1), least_h_);
}

template <class Velocity>
void OutlineSearch::collect(OutlineEvents& events, const Velocity& velocity) {
    std::array<const Candidate*, OutlineEvents::kMost> narrowest;
    for (size_t i = 0; i < narrowest.size(); ++i) narrowest[i] = &best_[i];
    std::sort(narrowest.begin(), narrowest.end(),
              [](const Candidate* a, const Candidate* b) { return a->width2 < b->width2; });
    /// Cosine of the angle within which two edges limit the light in the same direction.
    constexpr float kSameDirection = 0.87f;
    for (const Candidate* candidate : narrowest) {
        const Candidate& c = *candidate;
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
