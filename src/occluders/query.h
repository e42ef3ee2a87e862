/// Occluders beside a segment, found in the geometry itself: the outlines of everything that
/// stands near, as the segment's end sees them. No grid and no resolution.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>

#include "geometry/geometry.h"
#include "occluders/edge_measure.h"

namespace covtrace {

/// An outline beside a segment.
struct OutlineEvent {
    float z = 0;         ///< distance from the segment's end
    Vec3 direction;      ///< unit, at right angles to the segment and to the edge, towards it
    float distance = 0;  ///< of the edge from the segment, along `direction`
    Vec3 velocity;       ///< of the edge, scene units per unit of time
    float width = 0;     ///< as the search's EdgeMeasure has it
};

/// The few outlines that matter most, from the segment's beginning on.
struct OutlineEvents {
    static constexpr size_t kMost = 4;
    std::array<OutlineEvent, kMost> events;
    size_t count = 0;
};

class OccluderQuery {
  public:
    /// Finds the edges of all surfaces but interfaces, with instances and moving shapes where they
    /// are at a query's time. Spheres are exact; other curved shapes are fine polygons. Flat shapes
    /// have the holes that their alpha textures cut, in pieces of a 64th of a triangle's edge or,
    /// where these would be too many, larger ones: a 32nd, and so on down to a quarter; with more
    /// than 125,000 triangles that have holes, such shapes count as whole. Once `cancelled` says
    /// yes, no more shapes are looked at, and there are none. Throws Error(limit) where memory runs
    /// out.
    explicit OccluderQuery(const Geometry& geometry, std::function<bool()> cancelled = {});
    ~OccluderQuery();
    OccluderQuery(const OccluderQuery&) = delete;
    OccluderQuery& operator=(const OccluderQuery&) = delete;

    /// The surface that a segment starts or ends on. A curved one does not occlude what starts on
    /// it: its polygons are beside its true surface.
    struct Owner {
        static constexpr uint32_t kNone = ~uint32_t{0};
        uint32_t shape = kNone, instance = 0;
    };
    struct Segment {
        Vec3 begin, end;  ///< in the direction of light; `end` sees the outlines
        float time = 0;
        Owner at_begin, at_end;
    };
    /// The narrowest edge by `measure` in each of four sectors of direction, without those that
    /// repeat a narrower one's direction and those many times wider than the narrowest. `nearest`:
    /// edges that pass closer than this to either end do not count. The edges of meshes are found
    /// where a search first comes by. Thread-safe; the same whoever asks first. Throws
    /// Error(limit) where memory runs out.
    OutlineEvents operator()(const Segment& segment, const EdgeMeasure& measure,
                             float nearest) const;

    size_t edges() const;   ///< of all meshes; finds those that no search has come by
    size_t memory() const;  ///< bytes, of what was found so far

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace covtrace
