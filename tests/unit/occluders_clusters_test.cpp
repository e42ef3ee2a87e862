#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"
#include "geometry/placed_scene.h"
#include "geometry_fixtures.h"
#include "occluders/edge_clusters.h"
#include "occluders/query.h"

namespace covtrace {
namespace {

using namespace test;

/// The two ends of edges in steps of 2^-12 units, each edge's and all of them in order.
using Ends = std::array<std::array<long, 3>, 2>;
Ends ends_of(Vec3 a, Vec3 b) {
    const auto steps = [](Vec3 p) {
        return std::array{std::lround(4096 * p.x), std::lround(4096 * p.y),
                          std::lround(4096 * p.z)};
    };
    Ends ends{steps(a), steps(b)};
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
    std::vector<Ends> all, found;
    for (const FoldEdge& e : finder.edges()) all.push_back(ends_of(e.a, e.b));
    const Geometry g{scene_of({mesh(even), mesh(odd)})};
    std::vector<OccluderSurface> surfaces;
    for (const LocalShape& shape : g.impl().local) surfaces.push_back({Tessellation(shape, 1, 1)});
    const EdgeClusters clusters(std::move(surfaces));
    ASSERT_GT(clusters.hierarchy().items(), 8u);
    EXPECT_EQ(clusters.count(), all.size());

    for (size_t i = 0; i < clusters.hierarchy().items(); ++i)
        for (const EdgeBlock& block : clusters.edges(i).blocks)
            for (size_t k = 0; k < kLanes; ++k) {
                const Vec3 a{block.a.x[k], block.a.y[k], block.a.z[k]};
                const Vec3 along{block.along.x[k], block.along.y[k], block.along.z[k]};
                if (is_finite(a)) found.push_back(ends_of(a, a + along));
            }
    std::sort(all.begin(), all.end());
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, all);
}

TEST(EdgeClusters, PiecesHaveEdgesAroundThemAloneWhicheverClusterTheyAreIn) {
    const Geometry g{scene_of(
        {patches(patch({0, 0, 5}, {3, 0, 5}, {0, 2, 5}, {3, 2, 5})), mesh(unit_triangle())})};
    const auto count = [&](size_t shape, float u) {
        const LocalShape& local = g.impl().local[shape];
        OccluderSurface surface{Tessellation(local, 1, 1)};
        surface.holes = {&local, [u](const SurfacePoint& p) { return p.uv.x < u; }, 64};
        std::vector<OccluderSurface> surfaces;
        surfaces.push_back(std::move(surface));
        const EdgeClusters clusters(std::move(surfaces));
        // 64^2 pieces are too many for a cluster with more than one corner of the shape.
        EXPECT_GT(clusters.hierarchy().items(), 1u);
        return clusters.count();
    };
    EXPECT_EQ(count(0, 2), 4 * 64u);
    EXPECT_EQ(count(0, 0.5f), 2 * 64u + 2 * 32u);
    EXPECT_EQ(count(1, 2), 3 * 64u);
    EXPECT_EQ(count(1, -1), 0u);
}

TEST(EdgeClusters, TellWhatRanOutWhereMemoryDoes) {
    const Geometry g{scene_of({mesh(unit_triangle())})};
    const LocalShape& local = g.impl().local[0];
    OccluderSurface surface{Tessellation(local, 1, 1)};
    surface.holes = {&local, [](const SurfacePoint&) -> bool { throw std::bad_alloc(); }, 4};
    std::vector<OccluderSurface> surfaces;
    surfaces.push_back(std::move(surface));
    const EdgeClusters clusters(std::move(surfaces));
    try {
        clusters.edges(0);
        FAIL() << "no error";
    } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::limit);
        EXPECT_STREQ(e.what(), "out of memory while collecting the scene's outlines");
    }
}

TEST(EdgeClusters, CountTheMemoryOfTheirSurfaces) {
    const Geometry g{scene_of({mesh(unit_triangle())})};
    const LocalShape& local = g.impl().local[0];
    constexpr size_t kSurfaces = 1000;
    const auto memory = [&](size_t captured) {
        std::vector<OccluderSurface> surfaces;
        surfaces.reserve(kSurfaces);
        for (size_t i = 0; i < kSurfaces; ++i) {
            surfaces.push_back({Tessellation(local, 1, 1)});
            surfaces.back().holes = {&local, [](const SurfacePoint&) { return true; }, 4, captured};
        }
        return EdgeClusters(std::move(surfaces)).memory();
    };
    EXPECT_GT(memory(0), kSurfaces * (sizeof(OccluderSurface) + sizeof(size_t)));
    EXPECT_EQ(memory(100) - memory(0), kSurfaces * 100);
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
