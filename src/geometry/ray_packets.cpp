/// Many rays at once: in Embree's packets of eight, where these give the same bits as single rays.
#include "geometry/embree_shapes.h"
#include "geometry/placed_scene.h"

namespace covtrace {

namespace {

constexpr size_t kLanes = 8;

/// The lanes of a packet that hold a ray: -1 for these, 0 for the others.
struct alignas(32) ActiveLanes {
    int lane[kLanes] = {};
};

void set_lane(RTCRay8& out, size_t k, const Ray& ray, const ShutterClock& clock, unsigned mask) {
    out.org_x[k] = ray.origin.x, out.org_y[k] = ray.origin.y, out.org_z[k] = ray.origin.z;
    out.dir_x[k] = ray.direction.x, out.dir_y[k] = ray.direction.y, out.dir_z[k] = ray.direction.z;
    out.tnear[k] = 0;
    out.tfar[k] = ray.t_max;
    out.time[k] = clock.parameter(ray.time);
    out.mask[k] = mask;
    out.id[k] = 0;
    out.flags[k] = 0;
}

/// Calls trace(packet) for as many queries at a time as a packet holds.
template <typename Query, typename Trace>
void for_each_packet(std::span<Query> queries, const Trace& trace) {
    for (; queries.size() > kLanes; queries = queries.subspan(kLanes)) trace(queries.first(kLanes));
    if (!queries.empty()) trace(queries);
}

}  // namespace

void Geometry::Impl::find_nearest(std::span<HitQuery> packet) const {
    ActiveLanes active;
    RTCRayHit8 query;
    for (size_t k = 0; k < packet.size(); ++k) {
        if (!can_follow(*packet[k].ray)) continue;
        active.lane[k] = -1;
        set_lane(query.ray, k, *packet[k].ray, clock, ray_mask(packet[k].ray->kind));
        query.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
        query.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
    }
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect8(active.lane, top.scene.get(), &context, &query);
    std::array<const TriangleShape*, kLanes> triangles{};
    for (size_t k = 0; k < packet.size(); ++k) {
        packet[k].found = active.lane[k] != 0 && query.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID;
        if (!packet[k].found) continue;
        triangles[k] = std::get_if<TriangleShape>(
            &local[shape_of(query.hit.geomID[k], query.hit.instID[0][k])]);
        if (triangles[k]) prefetch_corner_numbers(*triangles[k], query.hit.primID[k]);
    }
    for (size_t k = 0; k < packet.size(); ++k)
        if (triangles[k]) prefetch_corners(*triangles[k], query.hit.primID[k]);
    for (size_t k = 0; k < packet.size(); ++k) {
        HitQuery& q = packet[k];
        if (q.found)
            fill({query.ray.tfar[k],
                  query.hit.geomID[k],
                  query.hit.instID[0][k],
                  query.hit.primID[k],
                  {query.hit.u[k], query.hit.v[k]}},
                 *q.ray, *q.hit);
    }
}

void Geometry::Impl::meet_any_solid(std::span<OcclusionQuery> packet, unsigned mask) const {
    ActiveLanes active;
    RTCRay8 query;
    for (size_t k = 0; k < packet.size(); ++k) {
        if (!can_follow(*packet[k].ray)) continue;
        active.lane[k] = -1;
        set_lane(query, k, *packet[k].ray, clock, mask);
    }
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded8(active.lane, top.scene.get(), &context, &query);
    for (size_t k = 0; k < packet.size(); ++k)
        packet[k].occluded = active.lane[k] != 0 && query.tfar[k] < 0;
}

// Where the nearest surface of a ray may not be what it stops at, the ray starts again on its own.

void Geometry::intersect(std::span<HitQuery> queries) const {
    if (!impl_->packets_are_exact || queries.size() == 1) {
        for (HitQuery& q : queries) q.found = intersect(*q.ray, *q.hit);
        return;
    }
    for_each_packet(queries, [this](std::span<HitQuery> packet) {
        impl_->find_nearest(packet);
        for (HitQuery& q : packet)
            if (q.found && impl_->placed[q.hit->shape].may_let_pass())
                q.found = intersect(*q.ray, *q.hit);
    });
}

void Geometry::intersect_seen(std::span<HitQuery> queries) const {
    if (!impl_->packets_are_exact || queries.size() == 1) {
        for (HitQuery& q : queries) q.found = intersect_seen(*q.ray, *q.hit);
        return;
    }
    intersect(queries);
    for (HitQuery& q : queries)
        if (q.found && lies_in(q.ray->origin, *q.hit)) q.found = intersect_seen(*q.ray, *q.hit);
}

void Geometry::occluded(std::span<OcclusionQuery> queries) const {
    impl_->meet_any(queries, kSolidMask);
}

void Geometry::blocked(std::span<OcclusionQuery> queries) const {
    impl_->meet_any(queries, kBlockingMask);
}

void Geometry::Impl::meet_any(std::span<OcclusionQuery> queries, unsigned mask) const {
    if (!packets_are_exact || queries.size() == 1) {
        for (OcclusionQuery& q : queries) q.occluded = meets_any(*q.ray, mask);
        return;
    }
    for_each_packet(
        queries, [this, mask](std::span<OcclusionQuery> packet) { meet_any_solid(packet, mask); });
    if (any_alpha && mask == kSolidMask)
        for (OcclusionQuery& q : queries)
            if (!q.occluded) q.occluded = meets_any(*q.ray, mask);
}

}  // namespace covtrace
