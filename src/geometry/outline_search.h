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
    Float4 bound_world(const BoxHierarchy::Node& node) const;
    /// An edge of the world that belongs to `body`.
    void meet(const FoldEdge& edge, uint32_t body) { meet(edge, edge.a, edge.b, end_, body); }

    /// The space of the edges that follow.
    void enter(const Affine& world_from_local);
    Vec3 local_end() const { return local_end_; }
    Float4 bound_local(const BoxHierarchy::Node& node) const;
    void meet_local(const FoldEdge& edge, uint32_t body) {
        meet(edge, to_world(edge.a), to_world(edge.b), local_end_, body);
    }

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
    Float4 bound(const std::array<Float4, 3>& middle, const std::array<Float4, 3>& half) const;
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
};

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
