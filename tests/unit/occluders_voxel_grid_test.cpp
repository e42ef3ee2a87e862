#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"
#include "geometry_fixtures.h"
#include "occluders/voxel_grid.h"
#include "occluders/voxel_walk.h"

namespace covtrace {
namespace {

using namespace test;

/// A scene of a square wall x < 0 in the plane z = 5 with an edge along y, in a box of about 20
/// units.
SceneDescription wall_scene() {
    return scene_of({patches(patch({-10, -10, 5}, {0, -10, 5}, {-10, 10, 5}, {0, 10, 5})),
                     mesh(unit_triangle(), AnimatedTransform(Transform::translate({9, 9, 15})))});
}

std::vector<VoxelWalk::Crossing> crossings(const VoxelGrid& grid, Vec3 from, Vec3 to) {
    std::vector<VoxelWalk::Crossing> all;
    VoxelWalk walk(grid, from, to);
    for (VoxelWalk::Crossing c; walk.next(c);) all.push_back(c);
    return all;
}

std::vector<OccluderEvent> events(const VoxelGrid& grid, Vec3 from, Vec3 to, float radius) {
    std::vector<OccluderEvent> all;
    VoxelMarch march(grid, from, to);
    for (OccluderEvent e; march.next(radius, e);) all.push_back(e);
    return all;
}

TEST(VoxelGrid, EmptySceneHasNoVoxelsAndNoEvents) {
    const VoxelGrid grid{Geometry{SceneDescription{}}};
    EXPECT_EQ(grid.occupied_voxels(), 0u);
    EXPECT_TRUE(events(grid, {-5, 0, 0}, {5, 0, 0}, 1).empty());
    EXPECT_EQ(grid.find({0, 0, 0}), nullptr);
}

TEST(VoxelGrid, RefusesSenselessWidths) {
    const Geometry g{SceneDescription{}};
    EXPECT_THROW(VoxelGrid(g, {.width = 0}), Error);
    EXPECT_THROW(VoxelGrid(g, {.width = 100000}), Error);
}

TEST(VoxelGrid, AreaNormalsAndCentroidsOfAWall) {
    const Geometry g{wall_scene()};
    const VoxelGrid grid(g, {.width = 100});
    const Voxel* v = grid.find({-5.03f, 2.07f, 5});
    ASSERT_NE(v, nullptr);
    EXPECT_NEAR(v->normals.zz, 1, 1e-5f);
    EXPECT_NEAR(v->normals.xx, 0, 1e-5f);
    EXPECT_NEAR(v->centroid.z, 5, 1e-5f);
    const float size = grid.voxel_size();
    EXPECT_NEAR(v->area, size * size, 0.3f * size * size);
    EXPECT_EQ(grid.find({-5, 2, 8}), nullptr);
    // The area of the whole wall is all there.
    double area = 0;
    for (float x = -10 + size / 2; x < 1; x += size)
        for (float y = -10 + size / 2; y < 10; y += size)
            if (const Voxel* w = grid.find({x, y, 5})) area += w->area;
    EXPECT_NEAR(area, 200, 2);
}

TEST(VoxelWalk, MeetsWhatStandsOnTheWayAndNothingBesideIt) {
    const Geometry g{wall_scene()};
    const VoxelGrid grid(g, {.width = 100});
    const float size = grid.voxel_size();
    const auto through = crossings(grid, {-5.03f, 2.07f, 2}, {-5.03f, 2.07f, 9});
    ASSERT_EQ(through.size(), 1u);
    EXPECT_EQ(through[0].voxel, grid.find({-5.03f, 2.07f, 5}));
    EXPECT_NEAR(through[0].s, 3, size);
    // A march sees the edge beside this ray, a walk does not.
    EXPECT_FALSE(events(grid, {1.5f * size, 2, 2}, {1.5f * size, 2, 9}, 3 * size).empty());
    EXPECT_TRUE(crossings(grid, {1.5f * size, 2, 2}, {1.5f * size, 2, 9}).empty());
    // Voxels that are occupied at either end are the surface's own.
    EXPECT_TRUE(crossings(grid, {-5.03f, 2.07f, 5}, {-5.03f, 2.07f, 9}).empty());
    EXPECT_TRUE(crossings(grid, {-5.03f, 2.07f, 2}, {-5.03f, 2.07f, 5}).empty());
}

/// Ways along the wall and past its end, in either direction.
TEST(VoxelWalk, CrossesEveryVoxelOfTheWayOnceAndInOrder) {
    const Geometry g{wall_scene()};
    const VoxelGrid grid(g, {.width = 100});
    const float size = grid.voxel_size();
    Random random(5);
    for (int i = 0; i < 200; ++i) {
        const Vec3 from{random.between(-9, -1), random.between(-9, 9), 5 + random.between(-3, 3)};
        const Vec3 to{random.between(-9, 15), random.between(-9, 9), 5 + random.between(-3, 3)};
        const auto found = crossings(grid, from, to);
        const Vec3 d = normalize(to - from);
        for (size_t k = 0; k < found.size(); ++k) {
            ASSERT_TRUE(k == 0 || found[k].s > found[k - 1].s) << i;
            ASSERT_EQ(found[k].voxel, grid.find(from + d * found[k].s)) << i;
        }
        // Small steps find the same voxels between the first and the last empty place, but for
        // voxels whose corners they miss.
        const float total = distance(from, to), step = 0.02f * size;
        float open = 0, close = total;
        while (open < total && grid.find(from + d * open)) open += step;
        while (close > 0 && grid.find(from + d * close)) close -= step;
        std::vector<const Voxel*> stepped;
        for (float s = open; s < close; s += step)
            if (const Voxel* v = grid.find(from + d * s))
                if (stepped.empty() || stepped.back() != v) stepped.push_back(v);
        for (const Voxel* v : stepped)
            ASSERT_TRUE(std::any_of(found.begin(), found.end(), [v](const auto& c) {
                return c.voxel == v;
            })) << i;
    }
    EXPECT_TRUE(crossings(grid, {0, 0, 5}, {0, 0, 5}).empty());
    EXPECT_TRUE(crossings(grid, {100, 100, 5}, {100, 200, 5}).empty());
}

TEST(VoxelGrid, RaysPastAnEdgeSeeItAtItsDistance) {
    const Geometry g{wall_scene()};
    const VoxelGrid grid(g, {.width = 150});
    const float size = grid.voxel_size();
    Random random(3);
    for (int i = 0; i < 500; ++i) {
        const float gap = random.between(0.2f, 2) * size, y = random.between(-8, 8);
        const Vec3 tilt{0.1f * random.between(-1, 1), 0.3f * random.between(-1, 1), 1};
        const Vec3 pass{gap, y, 5};
        const Vec3 from = pass + tilt * 4.0f, to = pass - tilt * 4.0f;
        const auto found = events(grid, from, to, 3 * size);
        ASSERT_EQ(found.size(), 1u);
        const OccluderEvent& e = found[0];
        const Vec3 d = normalize(to - from);
        ASSERT_NEAR(e.s, distance(from, pass), 1.5f * size);
        ASSERT_NEAR(dot(e.offset, d), 0, 1e-4f);
        ASSERT_LT(e.offset.x, 0.2f * size);
        // The edge voxel's centroid lies up to half a voxel inside the edge.
        ASSERT_NEAR(e.distance, gap, size);
        ASSERT_GE(e.distance, 0.5f * size);
        ASSERT_NEAR(e.normals.zz, 1, 1e-4f);
        // The same edge is at the rest of the way from the other end.
        const auto back = events(grid, to, from, 3 * size);
        ASSERT_EQ(back.size(), 1u);
        ASSERT_NEAR(back[0].s + e.s, distance(from, to), 1.5f * size);
    }
}

TEST(VoxelGrid, TheRadiusLimitsWhatCounts) {
    const Geometry g{wall_scene()};
    const VoxelGrid grid(g, {.width = 150});
    const float size = grid.voxel_size();
    const auto count = [&](float gap, float radius) {
        return events(grid, {gap, 0, 9}, {gap, 0, 1}, radius).size();
    };
    EXPECT_EQ(count(2 * size, 0.9f * size), 0u);
    EXPECT_EQ(count(1.9f * size, 3 * size), 1u);
    EXPECT_EQ(count(5 * size, 100 * size), 0u);  // never beyond 3 voxels
    EXPECT_EQ(count(size, 0), 0u);
}

TEST(VoxelGrid, TheEndsOfASegmentAreLeftOut) {
    const Geometry g{wall_scene()};
    const VoxelGrid grid(g, {.width = 150});
    const float size = grid.voxel_size();
    EXPECT_TRUE(events(grid, {-5, 0, 5}, {-5, 0, 1}, 3 * size).empty());
    EXPECT_TRUE(events(grid, {-5, 0, 1}, {-5, 0, 5}, 3 * size).empty());
    EXPECT_TRUE(events(grid, {-5, 0, 1}, {-5, 0, 1}, 3 * size).empty());
    EXPECT_EQ(events(grid, {-5, 0, 9}, {-5, 0, 1}, 3 * size).size(), 1u);
}

TEST(VoxelGrid, AlongASurfaceThereIsOneEventPerThreeVoxels) {
    const Geometry g{wall_scene()};
    const VoxelGrid grid(g, {.width = 150});
    const float size = grid.voxel_size();
    const auto found = events(grid, {-9, 0.03f, 5 + size}, {-1, 0.03f, 5 + size}, 3 * size);
    EXPECT_NEAR(static_cast<float>(found.size()), 8 / size / 3, 2);
    for (size_t i = 0; i + 1 < found.size(); ++i) EXPECT_GT(found[i + 1].s, found[i].s);
}

TEST(VoxelGrid, MarchFindsWhatBruteForceFinds) {
    Random random(12);
    SceneDescription scene;
    for (int i = 0; i < 60; ++i)
        scene.shapes.push_back(
            mesh(unit_triangle(),
                 AnimatedTransform(Transform::translate(random.in_box(5)) *
                                   Transform::rotate(360 * random.next(), random.direction()) *
                                   Transform::scale(random.next(), 2, 1))));
    const Geometry g{scene};
    const VoxelGrid grid(g, {.width = 60});
    const float size = grid.voxel_size();
    std::vector<Vec3> centroids;
    const Bounds3 box = g.bounds();
    for (float x = box.lo.x + size / 2; x < box.hi.x + size; x += size)
        for (float y = box.lo.y + size / 2; y < box.hi.y + size; y += size)
            for (float z = box.lo.z + size / 2; z < box.hi.z + size; z += size)
                if (const Voxel* v = grid.find({x, y, z})) centroids.push_back(v->centroid);
    ASSERT_EQ(centroids.size(), grid.occupied_voxels());
    int with_events = 0;
    for (int i = 0; i < 2000; ++i) {
        const Vec3 from = random.in_box(9), to = random.in_box(9);
        const float radius = random.between(0.3f, 3) * size, total = distance(from, to);
        const Vec3 d = normalize(to - from);
        const auto found = events(grid, from, to, radius);
        with_events += !found.empty();
        // The nearest voxel of all is among the events, unless it shares a slab with a nearer one;
        // and the first event is never farther along than the first candidate's slab.
        float nearest = kInfinity, first = kInfinity;
        for (Vec3 c : centroids) {
            const float s = dot(c - from, d);
            if (s < 1.5f * size + 1e-3f || s > total - 1.5f * size - 1e-3f) continue;
            const float r = length_squared(c - from - d * s);
            if (r >= sqr(0.999f * radius)) continue;
            nearest = std::min(nearest, r);
            first = std::min(first, s);
        }
        if (nearest == kInfinity) continue;
        ASSERT_FALSE(found.empty());
        float best = kInfinity;
        for (const OccluderEvent& e : found) best = std::min(best, length(e.offset));
        ASSERT_NEAR(best, std::sqrt(nearest), 1e-3f);
        ASSERT_LE(found[0].s, first + 3 * size);
    }
    EXPECT_GT(with_events, 300);
}

TEST(VoxelGrid, MovingOccludersCarryTheirVelocity) {
    const AnimatedTransform slide(Transform::translate({-1, 0, 0}), 0,
                                  Transform::translate({1, 0.5f, 0}), 2);
    SceneDescription scene =
        scene_of({patches(patch({-1, -1, 0}, {0, -1, 0}, {-1, 1, 0}, {0, 1, 0}), slide),
                  shape(sphere(0.2f), AnimatedTransform(Transform::translate({5, 5, 5})))});
    scene.camera.shutter_close = 2;
    const Geometry g{scene};
    const VoxelGrid grid(g, {.width = 200});
    const float size = grid.voxel_size();
    // At mid shutter the edge is at x = 0.
    const auto found = events(grid, {size, 0, 2}, {size, 0, -2}, 3 * size);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(found[0].distance, size, size);
    EXPECT_LT(distance(found[0].velocity, {1, 0.25f, 0}), 1e-3f);
    const Voxel* still = grid.find({5.2f - 0.1f * size, 5, 5});
    ASSERT_NE(still, nullptr);
    EXPECT_EQ(still->velocity, Vec3{});
    // Spread over the shutter, the edge has been at x = 0.5 too, with a part of the area.
    const VoxelGrid spread(g, {.width = 200, .shutter_samples = 4});
    EXPECT_NE(spread.find({0.6f, 0, 0}), nullptr);
    EXPECT_EQ(grid.find({0.6f, 0, 0}), nullptr);
}

TEST(VoxelGrid, CurvedAndInstancedShapesAreEntered) {
    SceneDescription scene =
        scene_of({shape(sphere(3)),
                  shape(Disk{0, 2, 1, 360}, AnimatedTransform(Transform::translate({8, 0, 0})))});
    scene.objects.push_back({"o", {patches(patch({0, 0, 0}, {1, 0, 1}, {0, 1, 1}, {1, 1, 0}))}});
    scene.instances.push_back(
        {0, AnimatedTransform(Transform::translate({-8, 0, 0}) * Transform::scale(2, 2, 2)), {}});
    scene.materials.push_back({"", InterfaceMaterial{}, {}});
    ShapeDescription invisible = shape(sphere(3.5f));
    invisible.material = 0;
    invisible.inside = 0;
    scene.media.push_back({});
    scene.shapes.push_back(invisible);
    const Geometry g{scene};
    const VoxelGrid grid(g, {.width = 180});
    Random random(9);
    for (int i = 0; i < 500; ++i) {
        const Vec3 d = random.direction();
        const Voxel* v = grid.find(d * 2.999f);
        const Voxel* w = grid.find(d * (3 - grid.voxel_size()));
        ASSERT_TRUE(v || w);
        if (v) {
            EXPECT_NEAR(length(v->centroid), 3, 0.02f);
        }
        const float phi = 2 * kPi * random.next();
        ASSERT_NE(grid.find({8 + 1.5f * std::cos(phi), 1.5f * std::sin(phi), 0}), nullptr);
        ASSERT_EQ(grid.find({8 + 0.8f * std::cos(phi), 0.8f * std::sin(phi), 0}), nullptr);
        ASSERT_EQ(grid.find(d * 3.5f), nullptr);
    }
    EXPECT_NE(grid.find(Vec3{-8, 0, 0} + Vec3{1, 1, 1}), nullptr);
}

TEST(VoxelGrid, ABoxCutsAwayTheRest) {
    const Geometry g{wall_scene()};
    const VoxelGrid grid(g, {.width = 50, .box = {{-1, -1, 4}, {1, 1, 6}}});
    EXPECT_NEAR(grid.voxel_size(), 0.04f, 1e-6f);
    EXPECT_NE(grid.find({-0.5f, 0.5f, 5}), nullptr);
    EXPECT_EQ(grid.find({-2, 0, 5}), nullptr);
    const float size = grid.voxel_size();
    const auto found = events(grid, {size, 0, 1e5f}, {size, 0, -1e5f}, 3 * size);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(found[0].s, 1e5f - 5, 0.1f);
}

TEST(VoxelGrid, AFarCornerDoesNotSwallowTheScene) {
    TriangleMesh ball = sphere_mesh(2, 40, 60);
    ball.positions.push_back({1e26f, 3e25f, -1e26f});
    ball.triangles.push_back({0, 1, static_cast<uint32_t>(ball.positions.size() - 1)});
    const Geometry g{scene_of({mesh(ball)})};
    const VoxelGrid grid(g, {.width = 100});
    EXPECT_LT(grid.voxel_size(), 0.5f);
    EXPECT_GT(grid.occupied_voxels(), 1000u);
    EXPECT_NE(grid.find({1.999f, 0, 0}), nullptr);
}

TEST(VoxelGrid, EndsEmptyWhenCancelled) {
    const Geometry g{scene_of({mesh(sphere_mesh(2, 40, 60))})};
    const VoxelGrid grid(g, {.width = 100, .cancelled = [] { return true; }});
    EXPECT_EQ(grid.occupied_voxels(), 0u);
    EXPECT_EQ(grid.find({1.999f, 0, 0}), nullptr);
    EXPECT_TRUE(events(grid, {2.02f, 0, 5}, {2.02f, 0, -5}, 1).empty());
}

/// The bytes per occupied voxel let 400 voxels of width stay below 1 GiB where a million triangles
/// are scattered; this is a size that is quick to test.
TEST(VoxelGrid, ScatteredTrianglesNeedLittleMemory) {
    Random random(4);
    TriangleMesh dust;
    for (uint32_t i = 0; i < 20000; ++i) {
        const Vec3 p = random.in_box(5);
        for (int k = 0; k < 3; ++k) dust.positions.push_back(p + random.in_box(0.02f));
        dust.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    const Geometry g{scene_of({mesh(std::move(dust))})};
    const VoxelGrid grid(g, {.width = 200});
    EXPECT_GT(grid.occupied_voxels(), 20000u);
    // The bound is 55 bytes a voxel, 340 a brick; at most 26^3 bricks and a margin around them.
    EXPECT_LT(grid.memory(), 55 * grid.occupied_voxels() + 350 * 28 * 28 * 28 + 4096);
}

TEST(VoxelGrid, TheSameBitsForAnyNumberOfThreads) {
    SceneDescription scene =
        scene_of({mesh(sphere_mesh(2, 100, 200)), shape(sphere(1)),
                  mesh(unit_triangle(),
                       AnimatedTransform(Transform{}, 0, Transform::rotate(90, {0, 0, 1}), 1))});
    const Geometry g{scene};
    const auto all = [&](int threads) {
        const ThreadLimit limit(threads);
        const VoxelGrid grid(g, {.width = 64});
        std::vector<float> numbers;
        for (int i = 0; i < 64 * 64 * 64; ++i) {
            const Vec3 cell{static_cast<float>(i % 64), static_cast<float>(i / 64 % 64),
                            static_cast<float>(i / 4096)};
            const Voxel* v =
                grid.find(g.bounds().lo + (cell + Vec3{0.5f, 0.5f, 0.5f}) * grid.voxel_size());
            if (v)
                numbers.insert(numbers.end(), {v->area, v->centroid.x, v->centroid.y, v->velocity.x,
                                               v->normals.xy, v->normals.zz});
        }
        return numbers;
    };
    const auto one = all(1);
    EXPECT_GT(one.size(), 10000u);
    EXPECT_EQ(one, all(2));
    EXPECT_EQ(one, all(0));
}

}  // namespace
}  // namespace covtrace
