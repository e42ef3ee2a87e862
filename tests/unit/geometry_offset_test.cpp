#include <gtest/gtest.h>

#include "geometry_fixtures.h"

namespace covtrace {
namespace {

using namespace test;

struct OffsetStatistics {
    int hits = 0;
    int self_hits = 0;
    float largest_gap = 0;  ///< relative to the largest coordinate or extent
};

enum class Bends { flat, convex, twisted };

/// Shoots at a shape about `center`, leaves every hit to both sides and counts the rays that meet
/// the surface at once where they must not.
OffsetStatistics leave_surface(const Geometry& g, Vec3 center, float size, Bends bends,
                               uint64_t seed) {
    OffsetStatistics s;
    Random random(seed);
    for (int i = 0; i < 40000; ++i) {
        const Vec3 origin = center + random.direction() * (size * random.between(1.5f, 20));
        const Vec3 target = center + random.in_box(0.6f * size);
        SurfaceHit hit;
        const float time = random.next();
        if (!g.intersect({origin, normalize(target - origin), time}, hit)) continue;
        ++s.hits;
        for (float side : {-1.0f, 1.0f}) {
            // Directions are grazing, too: these are the hard ones.
            Vec3 d = random.direction();
            if (i % 2) d = normalize(d - hit.ng * (dot(d, hit.ng) * 0.99f));
            if (dot(d, hit.ng) * side < 0) d = -d;
            const Vec3 o = Geometry::offset_origin(hit, d);
            SurfaceHit again;
            // A flat shape is never met again, nor a convex one from outside; other surfaces bend
            // by less than this range within it, but for grazing rays.
            float range = kInfinity;
            if (bends == Bends::twisted || (bends == Bends::convex && side < 0)) {
                if (std::abs(dot(d, hit.ng)) < 0.05f) continue;
                range = 0.02f * size;
            }
            if (g.intersect({o, d, time, range}, again)) ++s.self_hits;
            const float scale = std::max({std::abs(o.x), std::abs(o.y), std::abs(o.z), size});
            s.largest_gap = std::max(s.largest_gap, distance(o, hit.position) / scale);
        }
    }
    return s;
}

void expect_clean(const ShapeDescription& s, Vec3 center, float size, Bends bends,
                  const char* what) {
    const OffsetStatistics r = leave_surface(Geometry{scene_of({s})}, center, size, bends, 31);
    EXPECT_GT(r.hits, 2000) << what;
    EXPECT_EQ(r.self_hits, 0) << what << " at " << center.x;
    EXPECT_LT(r.largest_gap, 1e-5f) << what;
}

ShapeDescription flat(Vec3 center, float size, const Transform& turn, int kind) {
    const Transform place =
        Transform::translate(center) * turn * Transform::scale(size, size, size);
    TriangleMesh m;
    m.positions = {{-1, -1, 0}, {1, -1, 0}, {0, 1.5f, 0}};
    m.triangles = {{0, 1, 2}};
    if (kind == 0) return mesh(m, AnimatedTransform(place));
    if (kind == 1) return shape(Disk{0, 1, 0, 360}, AnimatedTransform(place));
    if (kind == 2)
        return patches(patch({-1, -1, 0}, {1, -1, 0}, {-1, 1, 0}, {1, 1, 0}),
                       AnimatedTransform(place));
    return patches(patch({-1, -1, 0.3f}, {1, -1, -0.2f}, {-1, 1, -0.1f}, {1, 1, 0.5f}),
                   AnimatedTransform(place));
}

TEST(GeometryOffset, FlatShapesNearAndFar) {
    const Transform turn = Transform::rotate(37, {1, 2, 3});
    for (float far : {0.0f, 100.0f, 1e4f})
        for (int kind = 0; kind < 3; ++kind)
            expect_clean(flat({far, -0.7f * far, 0.3f * far}, 1, turn, kind),
                         {far, -0.7f * far, 0.3f * far}, 1, Bends::flat, "flat");
}

TEST(GeometryOffset, LargeAndSmallFlatShapes) {
    const Transform turn = Transform::rotate(-63, {3, 1, -2});
    for (float size : {1e-3f, 1e3f})
        for (int kind = 0; kind < 3; ++kind)
            expect_clean(flat({1, 2, 3}, size, turn, kind), {1, 2, 3}, size, Bends::flat, "sized");
}

TEST(GeometryOffset, TwistedPatches) {
    for (float far : {0.0f, 1e4f})
        expect_clean(flat({far, far, far}, 1, Transform::rotate(20, {0, 1, 1}), 3), {far, far, far},
                     1, Bends::twisted, "twisted");
}

TEST(GeometryOffset, SpheresNearAndFar) {
    for (float far : {0.0f, 1e4f}) {
        const Vec3 center{far, far, -far};
        expect_clean(shape(sphere(1), AnimatedTransform(Transform::translate(center))), center, 1,
                     Bends::convex, "sphere");
        const Transform squash = Transform::translate(center) * Transform::rotate(40, {1, 1, 0}) *
                                 Transform::scale(1, 0.5, 0.8);
        expect_clean(shape(sphere(1), AnimatedTransform(squash)), center, 1, Bends::convex,
                     "ellipsoid");
    }
}

TEST(GeometryOffset, MovingAndInstancedShapes) {
    for (float far : {0.0f, 1e4f}) {
        const Vec3 center{far, -far, far};
        for (int kind = 0; kind < 4; ++kind) {
            ShapeDescription s =
                kind < 3 ? flat({0, 0, 0}, 1, Transform::rotate(37, {1, 2, 3}), kind)
                         : shape(sphere(1), AnimatedTransform(Transform::scale(1, 0.6, 1)));
            const Transform still = s.object_to_world.start();
            const Transform to = Transform::translate(center);
            const Transform turned = Transform::rotate(30, {0, 1, 0});
            s.object_to_world = AnimatedTransform(to * still, 0, to * turned * still, 1);
            const Bends bends = kind < 3 ? Bends::flat : Bends::convex;
            expect_clean(s, center, 1, bends, "moving");
            SceneDescription scene;
            s.object_to_world = AnimatedTransform(still);
            scene.objects.push_back({"o", {s}});
            scene.instances.push_back(
                {0, AnimatedTransform(to * turned * Transform::scale(1.2, 1, 0.9)), {}});
            const OffsetStatistics r = leave_surface(Geometry{scene}, center, 1, bends, 32);
            EXPECT_GT(r.hits, 2000);
            EXPECT_EQ(r.self_hits, 0) << "instanced " << kind << " at " << far;
            EXPECT_LT(r.largest_gap, 1e-5f);
        }
    }
}

}  // namespace
}  // namespace covtrace
