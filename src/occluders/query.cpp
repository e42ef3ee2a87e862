#include "occluders/query.h"

#include <new>

#include "occluders/bodies.h"
#include "occluders/outline_search.h"

namespace covtrace {

struct OccluderQuery::Impl : OccluderBodies {
    using OccluderBodies::OccluderBodies;
};

namespace {

/// Calls meet(edges) for the blocks of edges that a search comes by. `near`: the boxes of a node
/// that it enters, of the node alone or of the node and its blind cones.
template <class Limit, class Near, class Meet>
void search_clusters(const EdgeClusters& clusters, const Limit& limit, const Near& near,
                     const Meet& meet) {
    using Node = BoxHierarchy::Node;
    clusters.hierarchy().search(
        [&](const Node& node, uint32_t) { return near(node); }, limit,
        [&](uint32_t cluster) {
            const EdgeSet& set = clusters.edges(cluster);
            set.hierarchy.search(
                [&](const Node& node, uint32_t i) { return near(node, set.cones[i]); }, limit,
                [&](uint32_t i) { meet(set.blocks[i]); });
        });
}

}  // namespace

OccluderQuery::OccluderQuery(const Geometry& geometry, std::function<bool()> cancelled) {
    try {
        impl_ = std::make_unique<Impl>(geometry.impl(), std::move(cancelled));
    } catch (const std::bad_alloc&) {
        throw no_memory_for_outlines();
    }
}
OccluderQuery::~OccluderQuery() = default;

size_t OccluderQuery::edges() const {
    size_t count = 0;
    for (const EdgeClusters& set : impl_->sets) count += set.count();
    return count;
}

size_t OccluderQuery::memory() const {
    size_t bytes = impl_->hierarchy.memory() + impl_->bodies.capacity() * sizeof(OccluderBody);
    for (const EdgeClusters& set : impl_->sets) bytes += set.memory();
    return bytes + impl_->balls.capacity() * sizeof(BallBlock);
}

OutlineEvents OccluderQuery::operator()(const Segment& segment, const EdgeMeasure& measure,
                                        float nearest) const {
    const Impl& g = *impl_;
    OutlineSearch search(segment.begin, segment.end, measure, nearest);
    if (search.is_over() || g.hierarchy.empty()) return {};
    const auto is = [](Owner a, Owner b) { return a.shape == b.shape && a.instance == b.instance; };
    using Node = BoxHierarchy::Node;
    const auto limit = [&search] { return search.limit(); };
    g.hierarchy.search(
        [&](const Node& node, uint32_t) { return search.near_world(node); }, limit,
        [&](uint32_t index) {
            const OccluderBody& body = g.bodies[index];
            if (body.curved.shape != Owner::kNone &&
                (is(body.curved, segment.at_begin) || is(body.curved, segment.at_end)))
                return;
            if (body.kind == OccluderBody::Kind::balls) {
                const BallBlock& balls = g.balls[body.index];
                return search.meet_balls(
                    balls, balls.owned_by(segment.at_begin) | balls.owned_by(segment.at_end),
                    index);
            }
            if (body.kind == OccluderBody::Kind::moving_ball) {
                const OccluderBall ball = g.moved(body, segment.time);
                return search.meet_balls(BallBlock(std::span(&ball, 1)), 0, index);
            }
            const EdgeClusters& set = g.sets[body.index];
            if (!body.instance)
                return search_clusters(
                    set, limit,
                    [&](const auto&... of_node) { return search.near_world(of_node...); },
                    [&](const EdgeBlock& edges) { search.meet_world(edges, index); });
            search.enter(g.geometry.world_from_local(*body.instance, segment.time));
            search_clusters(
                set, limit, [&](const auto&... of_node) { return search.near_local(of_node...); },
                [&](const EdgeBlock& edges) { search.meet_local(edges, index); });
        });

    OutlineEvents events;
    if (!search.has_found()) return events;
    search.collect(events, [&](uint32_t index, Vec3 point) -> Vec3 {
        const EmbreeInstance* instance = g.bodies[index].instance;
        if (!instance || !instance->moves) return {};
        const Affine velocity = instance->motion.rate(segment.time, g.geometry.clock) *
                                g.geometry.world_from_local(*instance, segment.time).inverse();
        return velocity.point(Vec3d(point)).to_float();
    });
    return events;
}

}  // namespace covtrace
