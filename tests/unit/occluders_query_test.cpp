#include <gtest/gtest.h>

#include <vector>

#include "core/parallel.h"
#include "geometry/affine.h"
#include "geometry_fixtures.h"
#include "occluders/blind_cones.h"
#include "occluders/edge_block.h"
#include "occluders/query.h"

namespace covtrace {
namespace {

using namespace test;

/// A measure of width = distance / 2: edges alone, however far along the segment.
EdgeMeasure plain(float widest) {
    EdgeMeasure m;
    m.b = 0.25f;
    m.widest = widest;
    return m;
}

std::vector<OutlineEvent> outlines(const OccluderQuery& query, Vec3 begin, Vec3 end,
                                   const EdgeMeasure& measure, float time = 0) {
    const OutlineEvents found = query({begin, end, time, {}, {}}, measure, 1e-4f);
    return {found.events.begin(), found.events.begin() + static_cast<ptrdiff_t>(found.count)};
}

/// Boxes that a search meets, none of them first.
BoxHierarchy::Met any_order(const Mask8& boxes) {
    return {bits8(boxes), all8(0), all8(1)};
}

std::vector<FoldEdge> edges_of(const TriangleMesh& m) {
    FoldEdgeFinder finder;
    for (const auto& t : m.triangles)
        finder.add({m.positions[t[0]], m.positions[t[1]], m.positions[t[2]]});
    return finder.edges();
}

TEST(EdgeMeasure, ReachHoldsEveryDistanceWhereAnEdgeMatters) {
    Random random(5);
    for (int i = 0; i < 2000; ++i) {
        EdgeMeasure m;
        // The form h is quadratic with a positive matrix, as at surfaces.
        const float p = random.between(0, 2), q = random.between(0, 1), length = 3;
        m.a0 = i % 2 ? 0.0f : random.between(-1, 1);
        m.a1 = random.between(-1, 1);
        m.h0 = p * p + q;
        m.h1 = -2 * p * p / length * random.between(0, 1.2f);
        m.h2 = sqr(0.5f * m.h1 / std::max(p, 1e-3f)) + random.between(0, 0.1f);
        m.widest = random.between(0.01f, 2);
        const EdgeMeasure::Range range = m.reach(length);
        for (float z = 0.01f; z < length; z += 0.05f)
            if (m.width_squared(z, 0) < 0.99f * sqr(m.widest)) {
                ASSERT_LE(range.lo, z + 1e-3f);
                ASSERT_GE(range.hi, z - 1e-3f);
            }
    }
}

TEST(FoldEdges, FlatNeighboursLeaveNoEdge) {
    TriangleMesh square;
    square.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    square.triangles = {{0, 1, 2}, {0, 2, 3}};
    EXPECT_EQ(edges_of(square).size(), 4u);
    // The mesh is the same but for corners of its own.
    TriangleMesh apart;
    apart.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    apart.triangles = {{0, 1, 2}, {3, 4, 5}};
    EXPECT_EQ(edges_of(apart).size(), 4u);
    TriangleMesh broken = square;
    broken.positions[3].x = kInfinity;
    EXPECT_EQ(edges_of(broken).size(), 3u);
}

bool is_outline_from(const FoldEdge& edge, Vec3 p) {
    const EdgeBlock block(std::span(&edge, 1));
    return bits8(block.are_outlines(block.a - all8(p))) != 0;
}

TEST(FoldEdges, AnOutlineHasItsFacesOnOneSide) {
    // The mesh is a roof with its ridge along y.
    TriangleMesh roof;
    roof.positions = {{-1, 0, 0}, {0, 0, 1}, {0, 1, 1}, {1, 0, 0}};
    roof.triangles = {{0, 1, 2}, {1, 3, 2}};
    for (const FoldEdge& e : edges_of(roof)) {
        if (e.a.x != 0 || e.b.x != 0) continue;
        EXPECT_TRUE(is_outline_from(e, {5, 0.5f, 0.5f}));      // one face is hidden
        EXPECT_FALSE(is_outline_from(e, {0, 0.5f, 5}));        // both faces are seen
        EXPECT_FALSE(is_outline_from(e, {0, 0.5f, -5}));       // both faces are seen, from below
        EXPECT_FALSE(is_outline_from(e, {0.5f, 0.4f, 0.5f}));  // a point of a face
    }
}

TEST(FoldEdges, BlindConesHideNoOutline) {
    const TriangleMesh ball = sphere_mesh(1, 20, 40);
    std::vector<FoldEdge> found = edges_of(ball);
    std::vector<Bounds3> boxes(found.size());
    for (size_t i = 0; i < found.size(); ++i) {
        boxes[i].extend(found[i].a);
        boxes[i].extend(found[i].b);
    }
    const BoxHierarchy hierarchy(boxes, 8);
    std::vector<FoldEdge> edges;
    std::vector<size_t> first;
    for (size_t i = 0; i < hierarchy.items(); ++i) {
        first.push_back(edges.size());
        ASSERT_LE(hierarchy.item(i).size(), 8u);
        for (uint32_t e : hierarchy.item(i)) edges.push_back(found[e]);
    }
    ASSERT_EQ(edges.size(), found.size());
    const std::vector<BlindCones> cones = blind_cones(hierarchy, edges);
    Random random(8);
    for (int i = 0; i < 50; ++i) {
        const Vec3 p = random.direction() * random.between(1.1f, 4);
        std::vector<bool> met(edges.size(), false);
        size_t count = 0;
        hierarchy.search(
            [&](const BoxHierarchy::Node& node, uint32_t n) {
                const Vec3x8 middle = node.middle - all8(p);
                // Children that are missing are not numbers.
                return any_order((middle.x == middle.x) & ~cones[n].hide(middle));
            },
            [] { return kInfinity; },
            [&](uint32_t item) {
                const std::span own =
                    std::span(edges).subspan(first[item], hierarchy.item(item).size());
                const EdgeBlock block(own);
                const unsigned outlines = bits8(block.are_outlines(block.a - all8(p)));
                for (size_t k = 0; k < own.size(); ++k) {
                    met[first[item] + k] = true;
                    ++count;
                    // The rule is computed in double, where rounding does not decide.
                    const Vec3d d = Vec3d(own[k].a) - Vec3d(p), along(own[k].b - own[k].a);
                    const double far = length(cross(d, along)) / length(along),
                                 s0 = dot(d, Vec3d(own[k].normal0)) / far,
                                 s1 = dot(d, Vec3d(own[k].normal1)) / far;
                    const double sine = std::min(std::abs(s0), std::abs(s1));
                    if (std::abs(sine - 1e-3) < 1e-5) continue;
                    ASSERT_EQ((outlines >> k & 1) != 0, s0 * s1 > 0 && sine > 1e-3);
                }
                ASSERT_EQ(outlines >> own.size(), 0u);
            });
        for (size_t e = 0; e < edges.size(); ++e)
            if (is_outline_from(edges[e], p)) {
                ASSERT_TRUE(met[e]);
            }
        EXPECT_LT(count, edges.size() / 2);
    }
}

TEST(BoxHierarchy, HoldsEveryBoxOnce) {
    Random random(4);
    for (const size_t count : {1u, 2u, 8u, 9u, 70u, 5000u})
        for (const uint32_t per_item : {1u, 8u}) {
            std::vector<Bounds3> boxes(count);
            for (size_t i = 0; i < count; ++i) {
                // A third of the boxes lies at the very same place.
                const Vec3 p = i % 3 == 0 ? Vec3{1, 2, 3} : random.in_box(5);
                boxes[i].extend(p);
                boxes[i].extend(p + random.in_box(0.1f));
            }
            const BoxHierarchy hierarchy(boxes, per_item);
            std::vector<int> seen(count, 0);
            for (size_t i = 0; i < hierarchy.items(); ++i) {
                ASSERT_GE(hierarchy.item(i).size(), 1u);
                ASSERT_LE(hierarchy.item(i).size(), per_item);
                for (uint32_t b : hierarchy.item(i)) ++seen[b];
            }
            ASSERT_EQ(seen, std::vector<int>(count, 1));
            // Items whose boxes hold a point are met.
            for (int i = 0; i < 20; ++i) {
                const Vec3 p = i % 2 ? Vec3{1, 2, 3} : random.in_box(5);
                std::vector<bool> met(hierarchy.items(), false);
                hierarchy.search(
                    [&](const BoxHierarchy::Node& node, uint32_t) {
                        const Vec3x8 d = abs8(node.middle - all8(p)) - node.half;
                        return any_order(max8(max8(d.x, d.y), d.z) < all8(1e-6f));
                    },
                    [] { return kInfinity; }, [&](uint32_t item) { met[item] = true; });
                for (size_t item = 0; item < hierarchy.items(); ++item)
                    for (uint32_t b : hierarchy.item(item))
                        if (boxes[b].contains(p)) {
                            ASSERT_TRUE(met[item]);
                        }
            }
        }
}

TEST(OccluderQuery, AnEdgeAtItsDistanceAndDirection) {
    // The scene is a wall x < 0 in the plane z = 5.
    const Geometry g{
        scene_of({patches(patch({-10, -10, 5}, {0, -10, 5}, {-10, 10, 5}, {0, 10, 5}))})};
    const OccluderQuery query(g);
    EXPECT_EQ(query.edges(), 4u);
    Random random(3);
    for (int i = 0; i < 500; ++i) {
        const float gap = random.between(0.001f, 0.9f);
        const Vec3 tilt{0.1f * random.between(-1, 1), 0.3f * random.between(-1, 1), 1};
        const Vec3 pass{gap, random.between(-8, 8), 5}, end = pass - tilt * 4.0f;
        const auto found = outlines(query, pass + tilt * 3.0f, end, plain(0.5f));
        ASSERT_EQ(found.size(), 1u);
        const OutlineEvent& e = found[0];
        const Vec3 d = normalize(tilt), axis{0, 1, 0};
        const Vec3 across = normalize(cross(d, axis));
        const float distance = std::abs(dot(pass - Vec3{0, 0, 5}, across));
        ASSERT_NEAR(e.distance, distance, 1e-4f);
        ASSERT_NEAR(dot(e.direction, d), 0, 1e-5f);
        ASSERT_NEAR(dot(e.direction, axis), 0, 1e-4f);
        ASSERT_LT(e.direction.x, 0);
        ASSERT_NEAR(e.width, 0.5f * distance, 1e-4f);
        ASSERT_NEAR(e.z, length(tilt) * 4, 0.11f);
    }
    EXPECT_TRUE(outlines(query, {1.1f, 0, 9}, {1.1f, 0, 1}, plain(0.5f)).empty());
    // A plane that starts at the segment's end is no outline, nor is anything behind an end.
    EXPECT_TRUE(outlines(query, {-1, 0, 9}, {-1, 0, 5}, plain(2)).empty());
    EXPECT_TRUE(outlines(query, {0.1f, 0, 4}, {0.1f, 0, 1}, plain(1)).empty());
}

TEST(OccluderQuery, FindsTheNarrowestOfAll) {
    Random random(12);
    SceneDescription scene;
    for (int i = 0; i < 80; ++i)
        scene.shapes.push_back(
            mesh(unit_triangle(),
                 AnimatedTransform(Transform::translate(random.in_box(5)) *
                                   Transform::rotate(360 * random.next(), random.direction()) *
                                   Transform::scale(random.next(), 2, 1))));
    const Geometry g{scene};
    const OccluderQuery query(g);
    ASSERT_EQ(query.edges(), 240u);
    int some = 0;
    for (int i = 0; i < 1000; ++i) {
        const Vec3 begin = random.in_box(7), end = random.in_box(7);
        const float length = distance(begin, end);
        EdgeMeasure m;
        m.a1 = random.between(0, 0.3f);
        m.b = 0.25f;
        m.h1 = -random.between(0, 2) / length;
        m.h2 = sqr(m.h1) / 4 + 0.01f;
        m.widest = 0.7f;
        const auto found = outlines(query, begin, end, m);
        // The narrowest edge is found by brute force, by points along every edge.
        const Vec3 axis = (begin - end) / length;
        float narrowest = sqr(m.widest);
        for (uint32_t s = 0; s < scene.shapes.size(); ++s) {
            const WorldTriangle t = g.world_triangle(s, 0, 0);
            const std::array<Vec3, 3> p{t.p0, t.p1, t.p2};
            for (size_t k = 0; k < 3; ++k)
                for (int j = 0; j <= 200; ++j) {
                    const Vec3 q =
                        p[k] + (p[(k + 1) % 3] - p[k]) * (static_cast<float>(j) / 200) - end;
                    const float z = dot(q, axis);
                    if (z < 1e-4f || z > length - 1e-4f) continue;
                    narrowest =
                        std::min(narrowest, m.width_squared(z, length_squared(q - axis * z)));
                }
        }
        if (narrowest == sqr(m.widest)) continue;
        ++some;
        ASSERT_FALSE(found.empty());
        float best = kInfinity;
        for (const OutlineEvent& e : found) best = std::min(best, e.width);
        ASSERT_LE(best, std::sqrt(narrowest) * 1.001f);
        ASSERT_GE(best, std::sqrt(narrowest) * 0.8f - 0.02f);
        for (size_t k = 0; k + 1 < found.size(); ++k) ASSERT_GE(found[k].z, found[k + 1].z);
    }
    EXPECT_GT(some, 300);
}

TEST(OccluderQuery, InstancesAndMotion) {
    const AnimatedTransform slide(Transform::translate({-1, 0, 0}), 0,
                                  Transform::translate({1, 0.5f, 0}), 2);
    SceneDescription scene =
        scene_of({patches(patch({-1, -1, 0}, {0, -1, 0}, {-1, 1, 0}, {0, 1, 0}), slide)});
    scene.objects.push_back(
        {"o", {patches(patch({-1, -1, 0}, {0, -1, 0}, {-1, 1, 0}, {0, 1, 0}))}});
    scene.instances.push_back(
        {0, AnimatedTransform(Transform::translate({20, 0, 0}) * Transform::scale(3, 2, 1)), {}});
    scene.camera.shutter_close = 2;
    const Geometry g{scene};
    const OccluderQuery query(g);
    for (float time : {0.0f, 0.7f, 1.0f, 1.9f}) {
        const float edge = time - 1;
        const auto found =
            outlines(query, {edge + 0.1f, 0, 2}, {edge + 0.1f, 0, -2}, plain(0.2f), time);
        ASSERT_EQ(found.size(), 1u);
        EXPECT_NEAR(found[0].distance, 0.1f, 1e-3f);
        EXPECT_LT(distance(found[0].velocity, {1, 0.25f, 0}), 1e-2f);
    }
    const auto placed = outlines(query, {20.05f, 1.5f, 2}, {20.05f, 1.5f, -2}, plain(0.2f));
    ASSERT_EQ(placed.size(), 1u);
    EXPECT_NEAR(placed[0].distance, 0.05f, 1e-4f);
    EXPECT_EQ(placed[0].velocity, Vec3{});
}

TEST(OccluderQuery, TheSameForAnyNumberOfThreads) {
    const Geometry g{scene_of({mesh(sphere_mesh(2, 150, 200)), shape(sphere(1))})};
    const auto all = [&](int threads) {
        const ThreadLimit limit(threads);
        const OccluderQuery query(g);
        Random random(2);
        std::vector<float> numbers;
        for (int i = 0; i < 200; ++i) {
            const auto found = outlines(query, random.in_box(4), random.in_box(4), plain(0.2f));
            for (const OutlineEvent& e : found)
                numbers.insert(numbers.end(), {e.z, e.distance, e.direction.x, e.width});
        }
        return numbers;
    };
    const auto one = all(1);
    EXPECT_GT(one.size(), 40u);
    EXPECT_EQ(one, all(2));
}

}  // namespace
}  // namespace covtrace
