/// The state of one search for outlines beside a segment: which boxes to enter, what was found.
/// Only for query.cpp.
#pragma once

#include <array>
#include <cmath>

#include "core/frame.h"
#include "geometry/affine.h"
#include "occluders/ball_block.h"
#include "occluders/blind_cones.h"
#include "occluders/edge_block.h"
#include "occluders/query.h"

namespace covtrace {

class OutlineSearch {
  public:
    /// Begins a search beside the segment from `begin` to `end`, in world space. Edges that pass
    /// closer than `nearest` (scene units) to either end do not count.
    OutlineSearch(Vec3 begin, Vec3 end, const EdgeMeasure& measure, float nearest);

    /// Whether the search ends before it begins: no edge can matter.
    bool is_over() const { return !(lo_ <= hi_); }

    /// The boxes of a node, in world space, that may hold an edge which is narrow enough; with
    /// `cones` boxes that hold no outline as seen from the segment's end are left out. The bounds
    /// of the boxes are squared widths.
    BoxHierarchy::Met near_world(const BoxHierarchy::Node& node);
    BoxHierarchy::Met near_world(const BoxHierarchy::Node& node, const BlindCones& cones);
    /// The squared width that an edge must stay below to be of interest; below 0 once the search
    /// has taken enough steps.
    float limit() const { return steps_left_ > 0 ? limit_ : -1.0f; }
    /// Looks at edges, in world space, that belong to `body`.
    void meet_world(const EdgeBlock& edges, uint32_t body);

    /// Sets the local space of the nodes and edges that near_local and meet_local are given next.
    void enter(const Affine& world_from_local);
    BoxHierarchy::Met near_local(const BoxHierarchy::Node& node);
    BoxHierarchy::Met near_local(const BoxHierarchy::Node& node, const BlindCones& cones);
    void meet_local(const EdgeBlock& edges, uint32_t body);

    /// Looks at whole balls: each is outlined by the circle on which its tangents from end_ touch
    /// it. The k-th ball is passed over where bit k of `left_out` is set.
    void meet_balls(const BallBlock& balls, unsigned left_out, uint32_t body);

    bool has_found() const { return has_found_; }
    /// Writes the outlines that were found; velocity(body, point) gives the velocity of a body's
    /// point.
    template <class Velocity>
    void collect(OutlineEvents& events, const Velocity& velocity);

  private:
    /// Most nodes and blocks of edges that are looked at, nearest first, after the first outline
    /// was found. Beside a cloud of occluders all of them would be near enough to matter, but the
    /// first ones matter as much as any (docs/decisions/0090).
    static constexpr int kMostSteps = 128;
    /// Steps that a block of balls, or entering an instance's space, counts for: it takes the time
    /// of so many nodes.
    static constexpr int kStepsPerBody = 4;

    struct Candidate {
        Vec3 point;    ///< relative to end_, in world space
        Vec3 towards;  ///< along OutlineEvent::direction or against it, of any length
        uint32_t body;
    };
    /// Curves whose squared width is, at t from t0 to t1, the quotient of two quadratics.
    struct Curves {
        Float8 t0, t1;
        Float8 z, dz;          ///< distance from the end, z + t dz
        Float8 r2, dr2, ddr2;  ///< squared distance from the axis, r2 + 2 t dr2 + t^2 ddr2
    };
    /// The places at which eight curves are narrowest.
    struct Nearest {
        Float8 width2;  ///< infinity where nothing of the curve is beside the segment
        Float8 t;       ///< the place along the curve, from t0 to t1
        Mask8 inside;   ///< all bits set where the place lies between the curve's ends
    };

    /// The boxes that may matter, given their middles relative to end_ and their half sizes, by
    /// axis.
    BoxHierarchy::Met may_matter(const Vec3x8& middle, const Vec3x8& half);
    /// The narrowest places of eight curves; `distance2(t)` gives squared distances from the axis.
    template <class Distance>
    Nearest nearest(const Curves& curves, const Distance& distance2) const;
    /// The clipped parts of eight edges: `from`, `along` are in world space, relative to end_.
    Nearest nearest(const Vec3x8& from, const Vec3x8& along) const;
    /// The least squared widths so far in the sectors that eight directions are in.
    Float8 widths2_of(const Vec3x8& towards) const;
    /// Looks at the eight edges of which `outlines` says that they are outlines; `from`, `along`
    /// are in world space, relative to end_.
    void meet(const Mask8& outlines, const Vec3x8& from, const Vec3x8& along, uint32_t body);
    /// Keeps an edge if it is the narrowest in its sector of direction. `point`: the place where it
    /// is narrowest, relative to end_; `is_inside`: that place lies between the edge's ends.
    void keep(float width2, Vec3 point, Vec3 along, bool is_inside, uint32_t body);
    void keep(float width2, const Candidate& candidate);

    Vec3 end_, axis_;  ///< `axis_`: unit, from the end to the beginning
    EdgeMeasure measure_;
    float lo_ = 1, hi_ = 0;  ///< range of distances from the end in which edges matter
    float limit_ = 0;        ///< squared width from which on an edge no longer matters
    int steps_left_ = kMostSteps;
    float widest2_ = 0;  ///< square of the measure's `widest`
    float least_ = 0;    ///< least value of the measure's denominator
    float sharp_ = 0;    ///< distance at which the blur is least; 0 where it is the same everywhere
    bool has_found_ = false;
    /// Least squared width so far in each sector of direction.
    std::array<float, OutlineEvents::kMost> widths2_{kInfinity, kInfinity, kInfinity, kInfinity};
    std::array<Candidate, OutlineEvents::kMost> best_;
    Frame frame_;  ///< about axis_, where anything was found

    // The space that enter() has set: rows of the linear part and translation of its map to the
    // world, and end_ in it.
    std::array<Vec3, 3> rows_;
    Vec3 shift_, local_end_;
};

inline BoxHierarchy::Met OutlineSearch::near_world(const BoxHierarchy::Node& node) {
    return may_matter(node.middle - all8(end_), node.half);
}

inline BoxHierarchy::Met OutlineSearch::near_world(const BoxHierarchy::Node& node,
                                                   const BlindCones& cones) {
    const Vec3x8 middle = node.middle - all8(end_);
    BoxHierarchy::Met met = may_matter(middle, node.half);
    met.bits &= ~bits8(cones.hide(middle));
    return met;
}

inline BoxHierarchy::Met OutlineSearch::may_matter(const Vec3x8& middle, const Vec3x8& half) {
    if (has_found_) --steps_left_;
    const EdgeMeasure& m = measure_;
    const Vec3x8 axis = all8(axis_);
    const Float8 along = dot8(middle, axis), reach = dot8(half, abs8(axis));
    const Float8 z0 = max8(along - reach, all8(lo_)), z1 = min8(along + reach, all8(hi_));
    // The distance across the axis has a lower bound: p leads from the axis to the box's middle, at
    // right angles, and the whole box lies beyond the plane across p at the distance beyond / |p|.
    // Both sides of the comparison are multiplied by the denominators, p2 among them, instead of
    // dividing. Equal sides count as met: where the products become too small for single precision
    // both are 0.
    const Vec3x8 p = subtract_product(axis, along, middle);
    const Float8 p2 = dot8(p, p);
    const Float8 beyond = max8(p2 - dot8(half, abs8(p)), Float8{});
    const Float8 scale = p2 + 1e-20f;
    const Float8 blur = multiply_add(all8(m.a1), min8(max8(all8(sharp_), z0), z1), all8(m.a0));
    const Float8 numerator = multiply_add(beyond * beyond, all8(m.b), blur * blur * scale);
    const Float8 h0 = all8(m.h0), h1 = all8(m.h1), h2 = all8(m.h2);
    const Float8 at0 = multiply_add(multiply_add(h2, z0, h1), z0, h0),
                 at1 = multiply_add(multiply_add(h2, z1, h1), z1, h0),
                 denominator = max8(max8(at0, at1), all8(least_)) * scale;
    return {bits8((z0 <= z1) & (numerator <= all8(limit_) * denominator)), numerator, denominator};
}

template <class Velocity>
void OutlineSearch::collect(OutlineEvents& events, const Velocity& velocity) {
    std::array<size_t, OutlineEvents::kMost> narrowest{0, 1, 2, 3};
    std::sort(narrowest.begin(), narrowest.end(),
              [this](size_t a, size_t b) { return widths2_[a] < widths2_[b]; });
    /// Cosine of the angle (30 degrees) within which two edges narrow the light in the same
    /// direction.
    constexpr float kSameDirection = 0.87f;
    for (const size_t sector : narrowest) {
        const float width2 = widths2_[sector];
        if (width2 == kInfinity || width2 > limit_) break;
        const Candidate& c = best_[sector];
        OutlineEvent e;
        const Vec3 unit = c.towards / length(c.towards);
        e.z = dot(c.point, axis_);
        const float side = dot(c.point - axis_ * e.z, unit);
        e.direction = side < 0 ? -unit : unit;
        e.distance = std::abs(side);
        bool repeats = false;
        for (size_t i = 0; i < events.count; ++i)
            repeats =
                repeats || std::abs(dot(events.events[i].direction, e.direction)) > kSameDirection;
        if (repeats) continue;
        e.width = std::sqrt(width2);
        e.velocity = velocity(c.body, end_ + c.point);
        size_t at = events.count++;
        for (; at > 0 && events.events[at - 1].z < e.z; --at)
            events.events[at] = events.events[at - 1];
        events.events[at] = e;
    }
}

}  // namespace covtrace
