#include "geometry/occluder_query.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <vector>

#include "core/error.h"
#include "geometry/box_hierarchy.h"
#include "geometry/fold_edges.h"
#include "geometry/geometry_impl.h"
#include "geometry/outline_search.h"
#include "geometry/tessellation.h"

namespace covtrace {

namespace {

/// Triangles that curved shapes may have together; each has at least a few hundred.
constexpr double kCurvedTriangles = 2e6;
constexpr double kMostAround = 64, kLeastAround = 16;  ///< pieces of a circle

/// Edges in the local space of a scene of Embree.
struct EdgeSet {
    std::vector<FoldEdge> edges;  ///< in the order of the hierarchy
    BoxHierarchy hierarchy;
    std::vector<BlindCones> cones;  ///< of its nodes

    explicit EdgeSet(std::vector<FoldEdge> found) {
        std::vector<Bounds3> boxes(found.size());
        for (size_t i = 0; i < found.size(); ++i) {
            boxes[i].extend(found[i].a);
            boxes[i].extend(found[i].b);
        }
        hierarchy = BoxHierarchy(boxes);
        edges.reserve(found.size());
        for (uint32_t i : hierarchy.order()) edges.push_back(found[i]);
        cones = blind_cones(hierarchy, edges);
    }
};

/// An edge set somewhere in the world.
struct Body {
    uint32_t set = 0;
    const EmbreeInstance* instance = nullptr;  ///< null: the set is in world space
    OccluderQuery::Owner curved;  ///< the curved shape that this is; none: flat triangles
};

bool is_flat(const LocalShape& shape) {
    const auto* patches = std::get_if<PatchShape>(&shape);
    return std::holds_alternative<TriangleShape>(shape) || (patches && patches->parallelograms);
}

Bounds3 transformed(const Bounds3& b, const Affine& map) {
    const Vec3d c = map.point(Vec3d(b.center())), h = map.absolute(Vec3d(b.diagonal() * 0.5f));
    Bounds3 r;
    // A little more, for the rounding to float.
    r.extend((c - h * 1.00001).to_float());
    r.extend((c + h * 1.00001).to_float());
    return r;
}

}  // namespace

struct OccluderQuery::Impl {
    const Geometry::Impl& geometry;
    std::function<bool()> cancelled;
    std::vector<EdgeSet> sets;
    std::vector<Body> bodies;  ///< in the order of `hierarchy`
    BoxHierarchy hierarchy;    ///< over the bodies, throughout the shutter

    Impl(const Geometry::Impl& g, std::function<bool()> stop)
        : geometry(g), cancelled(std::move(stop)) {
        size_t curved = 0;
        for (const LocalShape& shape : g.local)
            if (!is_flat(shape)) ++curved;
        // Triangles of a sphere: around * around, two per cell, half as many along.
        around_ = std::clamp(std::sqrt(kCurvedTriangles / std::max<double>(1, double(curved))),
                             kLeastAround, kMostAround);
        std::vector<std::vector<Body>> of_scene(g.scenes.size());
        for (const EmbreeInstance& instance : g.instances) {
            auto& parts = of_scene[instance.scene];
            if (parts.empty()) parts = add(g.scenes[instance.scene].shape_of_geometry);
            for (Body part : parts) {
                part.instance = &instance;
                if (part.curved.shape != Owner::kNone)
                    part.curved.instance =
                        static_cast<uint32_t>(&instance - g.instances.data()) + 1;
                bodies.push_back(part);
            }
        }
        // The top scene starts with the instances themselves.
        const auto& top = g.top.shape_of_geometry;
        for (const Body& part :
             add({top.begin() + static_cast<ptrdiff_t>(g.instances.size()), top.end()}))
            bodies.push_back(part);
        std::vector<Bounds3> boxes;
        for (const Body& body : bodies) boxes.push_back(bounds_of(body));
        hierarchy = BoxHierarchy(boxes);
        std::vector<Body> ordered;
        for (uint32_t i : hierarchy.order()) ordered.push_back(bodies[i]);
        bodies = std::move(ordered);
    }

    /// Edge sets of shapes that stand together: one for all that is flat, one for each that is not.
    std::vector<Body> add(const std::vector<uint32_t>& shapes) {
        FoldEdgeFinder flat;
        std::vector<Body> parts;
        for (uint32_t shape : shapes) {
            if (cancelled && cancelled()) break;
            if (geometry.is_interface[shape]) continue;
            const LocalShape& local = geometry.local[shape];
            if (is_flat(local)) {
                const Tessellation surface(local, 1, 1);
                flat.add(surface.positions(), surface.triangles());
                continue;
            }
            FoldEdgeFinder curved;
            const Tessellation surface(local, piece_of(local), 1);
            curved.add(surface.positions(), surface.triangles());
            keep(curved, {shape, 0}, parts);
        }
        keep(flat, {}, parts);
        return parts;
    }

    void keep(FoldEdgeFinder& finder, Owner curved, std::vector<Body>& parts) {
        std::vector<FoldEdge> edges = finder.take();
        if (edges.empty()) return;
        parts.push_back({static_cast<uint32_t>(sets.size()), nullptr, curved});
        sets.emplace_back(std::move(edges));
    }

    /// Scene units of the local space, so that a whole turn has around_ pieces.
    double piece_of(const LocalShape& shape) const {
        Bounds3 b;
        if (const auto* quadric = std::get_if<Quadric>(&shape)) {
            const Affine& m = quadric->local_from_object;
            const double widest = std::max({length(m.row[0]), length(m.row[1]), length(m.row[2])});
            return 2 * double(kPi) * quadric->radius * widest / around_;
        }
        for (Vec3 p : std::get<PatchShape>(shape).positions) b.extend(p);
        return std::max(4 * double(length(b.diagonal())) / around_, 1e-30);
    }

    Bounds3 bounds_of(const Body& body) const {
        const Bounds3& local = sets[body.set].hierarchy.bounds();
        if (!body.instance) return local;
        if (!body.instance->moves) return transformed(local, body.instance->still);
        // Between two times the corners move along a curve: the boxes of many times, with room for
        // what lies between them.
        constexpr int kTimes = 32;
        const ShutterClock& clock = geometry.clock;
        Bounds3 all, before;
        for (int i = 0; i <= kTimes; ++i) {
            const float f = static_cast<float>(i) / kTimes;
            const float time = clock.open() + f * (clock.close() - clock.open());
            const Bounds3 now = transformed(local, geometry.world_from_local(*body.instance, time));
            all.extend(now);
            if (i > 0) {
                const Vec3 step = max(max(now.lo - before.lo, before.lo - now.lo),
                                      max(now.hi - before.hi, before.hi - now.hi));
                all.extend(Bounds3{now.lo - step * 0.5f, now.hi + step * 0.5f});
            }
            before = now;
        }
        return all;
    }

    double around_ = kMostAround;
};

OccluderQuery::OccluderQuery(const Geometry& geometry, std::function<bool()> cancelled) {
    try {
        impl_ = std::make_unique<Impl>(geometry.impl(), std::move(cancelled));
    } catch (const std::bad_alloc&) {
        throw Error(ErrorKind::limit, "out of memory while collecting the scene's outlines");
    }
}
OccluderQuery::~OccluderQuery() = default;

size_t OccluderQuery::edges() const {
    size_t count = 0;
    for (const EdgeSet& set : impl_->sets) count += set.edges.size();
    return count;
}

size_t OccluderQuery::memory() const {
    size_t bytes = impl_->hierarchy.memory() + impl_->bodies.capacity() * sizeof(Body);
    for (const EdgeSet& set : impl_->sets)
        bytes += set.hierarchy.memory() + set.edges.capacity() * sizeof(FoldEdge) +
                 set.cones.capacity() * sizeof(BlindCones);
    return bytes;
}

OutlineEvents OccluderQuery::operator()(const Segment& segment, const EdgeMeasure& measure,
                                        float nearest) const {
    const Impl& g = *impl_;
    OutlineSearch search(segment.begin, segment.end, measure, nearest);
    if (search.is_over() || g.hierarchy.empty()) return {};
    const auto is = [](Owner a, Owner b) { return a.shape == b.shape && a.instance == b.instance; };
    const auto limit = [&search] { return search.limit(); };
    using Node = BoxHierarchy::Node;
    g.hierarchy.search(
        [&](const Node& node, uint32_t) { return search.bound_world(node); }, limit,
        [&](uint32_t index) {
            const Body& body = g.bodies[index];
            if (body.curved.shape != Owner::kNone &&
                (is(body.curved, segment.at_begin) || is(body.curved, segment.at_end)))
                return;
            const EdgeSet& set = g.sets[body.set];
            if (!body.instance) {
                set.hierarchy.search(
                    [&](const Node& node, uint32_t i) {
                        return set.cones[i].rule_out(node, segment.end, search.bound_world(node));
                    },
                    limit, [&](uint32_t i) { search.meet(set.edges[i], index); });
                return;
            }
            search.enter(g.geometry.world_from_local(*body.instance, segment.time));
            set.hierarchy.search(
                [&](const Node& node, uint32_t i) {
                    return set.cones[i].rule_out(node, search.local_end(),
                                                 search.bound_local(node));
                },
                limit, [&](uint32_t i) { search.meet_local(set.edges[i], index); });
        });

    OutlineEvents events;
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
