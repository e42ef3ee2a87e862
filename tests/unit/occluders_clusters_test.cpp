#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "core/parallel.h"
#include "geometry/placed_scene.h"
#include "geometry_fixtures.h"
#include "occluders/edge_clusters.h"
#include "occluders/query.h"

namespace covtrace {
namespace {

using namespace test;

/// The ends of edges, in order.
std::vector<std::array<float, 6>> ends_of(const std::vector<FoldEdge>& edges) {
    std::vector<std::array<float, 6>> ends;
    for (const FoldEdge& e : edges) ends.push_back({e.a.x, e.a.y, e.a.z, e.b.x, e.b.y, e.b.z});
    std::sort(ends.begin(), ends.end());
    return ends;
}

TEST(EdgeClusters, HoldEveryEdgeOnceWhicheverMeshItsFacesBelongTo) {
    // The triangles of a ball belong to two meshes by turns, so that every edge is between both.
    const TriangleMesh ball = sphere_mesh(2, 60, 80);
    TriangleMesh even = ball, odd = ball;
    even.triangles.clear();
    odd.triangles.clear();
    FoldEdgeFinder finder;
    for (size_t i = 0; i < ball.triangles.size(); ++i) {
        const auto& t = ball.triangles[i];
        (i % 2 == 0 ? even : odd).triangles.push_back(t);
        finder.add({ball.positions[t[0]], ball.positions[t[1]], ball.positions[t[2]]});
    }
    const auto all = ends_of(finder.take());
    const Geometry g{scene_of({mesh(even), mesh(odd)})};
    std::vector<Tessellation> surfaces;
    for (const LocalShape& shape : g.impl().local) surfaces.emplace_back(shape, 1, 1);
    const EdgeClusters clusters(std::move(surfaces));
    ASSERT_GT(clusters.hierarchy().items(), 8u);
    EXPECT_EQ(clusters.count(), all.size());

    std::vector<std::array<float, 6>> found;
    for (size_t i = 0; i < clusters.hierarchy().items(); ++i)
        for (const EdgeBlock& block : clusters.edges(i).blocks)
            for (size_t k = 0; k < kLanes; ++k) {
                const Vec3 a{block.a.x[k], block.a.y[k], block.a.z[k]};
                if (!is_finite(a)) continue;
                found.push_back({a.x, a.y, a.z, a.x + block.along.x[k], a.y + block.along.y[k],
                                 a.z + block.along.z[k]});
            }
    ASSERT_EQ(found.size(), all.size());
    std::sort(found.begin(), found.end());
    for (size_t i = 0; i < all.size(); ++i)
        for (size_t k = 0; k < 3; ++k) ASSERT_EQ(found[i][k], all[i][k]);
}

TEST(EdgeClusters, AreFoundWhereASearchComesBy) {
    const Geometry g{scene_of({mesh(sphere_mesh(2, 150, 200))})};
    const OccluderQuery query(g);
    EdgeMeasure m;
    m.b = 0.25f;
    m.widest = 0.01f;
    const size_t before = query.memory();
    EXPECT_EQ(query({{2.01f, 0, 1}, {2.01f, 0, -1}, 0, {}, {}}, m, 1e-4f).count, 1u);
    const size_t after = query.memory();
    EXPECT_GT(after, before);
    query.edges();
    EXPECT_GT(query.memory() - before, 4 * (after - before));
}

TEST(EdgeClusters, AreTheSameWhoeverAsksFirst) {
    const Geometry g{scene_of({mesh(sphere_mesh(2, 150, 200)), mesh(sphere_mesh(1, 90, 90))})};
    constexpr int kQueries = 400;
    const auto all = [&](int threads) {
        const ThreadLimit limit(threads);
        const OccluderQuery query(g);
        EdgeMeasure m;
        m.b = 0.25f;
        m.widest = 0.2f;
        std::vector<OutlineEvents> found(kQueries);
        parallel_for(kQueries, [&](int64_t i) {
            Random random(static_cast<uint64_t>(i) + 1);
            const Vec3 begin = random.in_box(4), end = random.in_box(4);
            found[static_cast<size_t>(i)] = query({begin, end, 0, {}, {}}, m, 1e-4f);
        });
        std::vector<float> numbers;
        for (const OutlineEvents& events : found)
            for (size_t i = 0; i < events.count; ++i) {
                const OutlineEvent& e = events.events[i];
                numbers.insert(numbers.end(), {e.z, e.distance, e.direction.x, e.width});
            }
        return numbers;
    };
    const std::vector<float> one = all(1);
    EXPECT_GT(one.size(), 80u);
    EXPECT_EQ(one, all(4));
}

}  // namespace
}  // namespace covtrace
