#include <gtest/gtest.h>

#include "core/parallel.h"
#include "geometry_fixtures.h"

namespace covtrace {
namespace {

using namespace test;

/// A triangle far larger than its surroundings, so that rays at its middle can't miss it.
TriangleMesh probe() {
    TriangleMesh m = unit_triangle();
    m.positions = {{-1, -1, 0.3f}, {1.5f, -0.5f, 0.2f}, {-0.5f, 1.5f, -0.4f}};
    return m;
}

Vec3 exact_point(const Transform& t, const TriangleMesh& m, Vec2 b) {
    const Vec3 p = m.positions[0] * (1 - b.x - b.y) + m.positions[1] * b.x + m.positions[2] * b.y;
    return t.point(p);
}

/// Shoots rays at the middle of the triangle where `exact` puts it at random times. Returns the
/// largest distance between that plane and the hit, and between the two points.
template <class At>
double worst_error(const Geometry& g, const TriangleMesh& m, float t0, float t1, At&& exact) {
    Random random(11);
    double worst = 0;
    for (int i = 0; i < 3000; ++i) {
        const float time =
            i < 3 ? (i == 0 ? t0 : (i == 1 ? t1 : 0.5f * (t0 + t1))) : random.between(t0, t1);
        const Transform t = exact(time);
        const Vec2 b{0.2f + 0.3f * random.next(), 0.2f + 0.3f * random.next()};
        const Vec3 p = exact_point(t, m, b);
        const Vec3 n = normalize(
            t.normal(cross(m.positions[1] - m.positions[0], m.positions[2] - m.positions[0])));
        SurfaceHit hit;
        if (!g.intersect({p + n * 2.0f, -n, time}, hit)) return 1e9;
        worst =
            std::max({worst, double(distance(hit.position, p)), double(length(cross(hit.ng, n)))});
        if ((dot(hit.ng, n) < 0) != g.shapes()[hit.shape].description.reverse_orientation)
            return 1e8;
    }
    return worst;
}

Transform random_transform(Random& random, bool mirror) {
    const auto factor = [&] { return random.between(0.5f, 2); };
    const float x = factor(), y = factor(), z = factor();
    Matrix4 skew;
    skew.m[0][1] = random.between(-0.5f, 0.5f);
    skew.m[1][2] = random.between(-0.5f, 0.5f);
    const Vec3 offset = random.in_box(3), axis = random.direction();
    return chain({Transform::translate(offset), Transform::rotate(random.between(0, 360), axis),
                  Transform::scale(mirror ? -x : x, y, z), *Transform::from_matrix(skew)});
}

TEST(GeometryMotion, RaysMeetMovingShapesWhereTheTransformPutsThem) {
    Random random(21);
    for (int trial = 0; trial < 12; ++trial) {
        const bool mirror = trial % 3 == 2;
        const AnimatedTransform motion(random_transform(random, mirror), 0,
                                       random_transform(random, mirror), 1);
        const Geometry g{scene_of({mesh(probe(), motion)})};
        EXPECT_LT(worst_error(g, probe(), 0, 1, [&](float t) { return motion.at(t); }), 3e-5)
            << trial;
    }
}

TEST(GeometryMotion, QuarterAndHalfTurnsAreCircles) {
    for (float degrees : {1.0f, 20.0f, 90.0f, 179.0f, 180.0f}) {
        const AnimatedTransform motion(Transform{}, 0, Transform::rotate(degrees, {0.3f, 1, 0.2f}),
                                       1);
        const Geometry g{scene_of({mesh(probe(), motion)})};
        EXPECT_LT(worst_error(g, probe(), 0, 1, [&](float t) { return motion.at(t); }), 2e-5)
            << degrees;
    }
}

TEST(GeometryMotion, ScalesBeforeRotationsAreMetWherePbrtPutsThem) {
    // The closed form of pbrt's interpolation: the rotation R by the angle, and the symmetric
    // stretches S and R^T S R of the keys S and S R. Embree's own way between two keys is another.
    struct Case {
        Transform scale;
        float degrees, error;
    };
    const Transform mild = Transform::scale(2, 1, 0.5), strong = Transform::scale(10, 1, 1);
    const Vec3 axis{0.3f, 1, 0.2f};
    for (const auto& [scale, degrees, error] :
         {Case{mild, 2, 5e-5f}, Case{mild, 30, 5e-5f}, Case{mild, 90, 5e-5f},
          Case{mild, 170, 2e-4f}, Case{strong, 90, 1.5e-3f}}) {
        const Transform turn = Transform::rotate(degrees, axis), end = scale * turn;
        const Transform turned = turn.inverse() * end;
        const auto exact = [&, scale = scale, degrees = degrees](float t) {
            Matrix4 stretch;
            for (size_t i = 0; i < 3; ++i)
                for (size_t j = 0; j < 3; ++j)
                    stretch.m[i][j] =
                        (1 - t) * scale.matrix().m[i][j] + t * turned.matrix().m[i][j];
            return Transform::rotate(degrees * t, axis) * *Transform::from_matrix(stretch);
        };
        const Geometry g{scene_of({mesh(probe(), AnimatedTransform(scale, 0, end, 1))})};
        EXPECT_LT(worst_error(g, probe(), 0, 1, exact), error) << degrees;
    }
}

TEST(GeometryMotion, ShapesRestOutsideTheirKeys) {
    const AnimatedTransform motion(
        Transform{}, 0.25f,
        chain({Transform::translate({1, 2, 0}), Transform::rotate(60, {0, 0, 1})}), 0.75f);
    SceneDescription scene = scene_of({mesh(probe(), motion)});
    for (const auto& [open, close] :
         {std::pair{0.0f, 1.0f}, {-1.0f, 3.0f}, {0.3f, 0.6f}, {0.5f, 2.0f}, {0.8f, 2.0f}}) {
        scene.camera.shutter_open = open;
        scene.camera.shutter_close = close;
        const Geometry g{scene};
        EXPECT_LT(worst_error(g, probe(), open, close, [&](float t) { return motion.at(t); }), 2e-5)
            << open;
    }
}

TEST(GeometryMotion, InstantShutterFreezesEverything) {
    const AnimatedTransform motion(Transform{}, 0, Transform::translate({4, 0, 0}), 1);
    SceneDescription scene = scene_of({mesh(probe(), motion)});
    scene.camera.shutter_open = scene.camera.shutter_close = 0.5f;
    const Geometry g{scene};
    EXPECT_LT(worst_error(g, probe(), 0.5f, 0.5f, [&](float) { return motion.at(0.5f); }), 2e-6);
    EXPECT_LT(g.bounds().hi.x, 4);
    EXPECT_EQ(g.world_triangle(0, 0, 0.9f).p0, motion.at(0.5f).point(probe().positions[0]));
}

TEST(GeometryMotion, BoundsHoldTheWholeSweep) {
    const AnimatedTransform spin(
        Transform::translate({2, 0, 0}), 0,
        Transform::rotate(180, {0, 0, 1}) * Transform::translate({2, 0, 0}), 1);
    const Geometry g{scene_of({shape(sphere(1), spin)})};
    Random random(5);
    for (int i = 0; i < 2000; ++i) {
        const Vec3 p = spin.at(random.next()).point(random.direction());
        for (int k = 0; k < 3; ++k) {
            EXPECT_GE(p[k], g.bounds().lo[k] - 1e-5f);
            EXPECT_LE(p[k], g.bounds().hi[k] + 1e-5f);
        }
    }
}

/// An object with one still and one moving triangle, four instances: still, mirrored, moving, both.
struct InstancedScene {
    TriangleMesh still = probe(), moving = probe();
    AnimatedTransform still_place{Transform::translate({0, 0, 9})};
    AnimatedTransform inner{
        Transform{}, 0.2f,
        chain({Transform::translate({0, 1, 0}), Transform::rotate(100, {0, 0, 1})}), 0.8f};
    std::vector<AnimatedTransform> outer;
    SceneDescription scene;

    InstancedScene() {
        scene.objects.push_back({"empty", {}});
        scene.objects.push_back({"pair", {mesh(still, still_place), mesh(moving, inner)}});
        const Transform far = Transform::translate({20, 0, 0});
        outer = {AnimatedTransform(Transform::scale(2, 2, 0.5)),
                 AnimatedTransform(far * Transform::scale(-1, 1, 1)),
                 AnimatedTransform(far * far, 0, far * far * Transform::rotate(90, {1, 1, 0}), 1),
                 AnimatedTransform(far * far * far * Transform::scale(1, 1, -1), 0,
                                   far * far * far * Transform::rotate(-50, {0, 1, 0}) *
                                       Transform::scale(1, 2, -1),
                                   0.5f)};
        for (const AnimatedTransform& t : outer) {
            scene.instances.push_back({0, t, {}});
            scene.instances.push_back({1, t, {}});
        }
        scene.shapes = {shape(sphere(0.5f), AnimatedTransform(Transform::translate({0, 50, 0})))};
    }
};

TEST(GeometryMotion, InstancesOfStillAndMovingShapes) {
    const InstancedScene s;
    const Geometry g{s.scene};
    ASSERT_EQ(g.shapes().size(), 3u);
    EXPECT_FALSE(g.shapes()[0].is_instanced);
    EXPECT_TRUE(g.shapes()[1].is_instanced);
    for (const AnimatedTransform& outer : s.outer) {
        EXPECT_LT(worst_error(g, s.still, 0, 1,
                              [&](float t) { return outer.at(t) * s.still_place.at(t); }),
                  5e-5);
        EXPECT_LT(
            worst_error(g, s.moving, 0, 1, [&](float t) { return outer.at(t) * s.inner.at(t); }),
            1e-4);
    }
    SurfaceHit hit;
    ASSERT_TRUE(g.intersect({{0, 50, 3}, {0, 0, -1}, 0.5f}, hit));
    EXPECT_EQ(hit.shape, 0u);
    EXPECT_EQ(hit.instance, 0u);
}

TEST(GeometryMotion, VelocityAgainstFiniteDifferences) {
    const InstancedScene s;
    const Geometry g{s.scene};
    for (const AnimatedTransform& outer : s.outer)
        for (float time : {0.0f, 0.1f, 0.35f, 0.5f, 0.77f, 0.9f}) {
            const auto at = [&](float t) { return outer.at(t) * s.inner.at(t); };
            const Vec2 b{0.3f, 0.4f};
            const Vec3 p = exact_point(at(time), s.moving, b);
            const Vec3 n = normalize(at(time).normal({0.2f, 0.1f, 1}));
            SurfaceHit hit;
            ASSERT_TRUE(g.intersect({p + n, -n, time}, hit));
            const DifferentialGeometry d = g.differential(hit);
            const float h = 1e-3f, t0 = std::max(0.0f, time - h);
            // At the kink of the last instance the later side counts.
            const float from = time == 0.5f ? time : t0;
            const Vec3 v =
                (exact_point(at(time + h), s.moving, b) - exact_point(at(from), s.moving, b)) /
                (time + h - from);
            EXPECT_LT(distance(d.velocity, v), 0.01f * (1 + length(v))) << time;
        }
}

TEST(GeometryMotion, AngularVelocityOfASpin) {
    const Vec3 axis = normalize({1, 2, -1});
    for (const Transform& size :
         {Transform::scale(1, 1, 1), Transform::scale(3, 0.5, 2), Transform::scale(-1, 1, 1)}) {
        const AnimatedTransform spin(size, 0, Transform::rotate(90, axis) * size, 2);
        SceneDescription scene = scene_of({shape(sphere(1), spin)});
        scene.camera.shutter_close = 2;
        const Geometry g{scene};
        SurfaceHit hit;
        ASSERT_TRUE(g.intersect({{0, 0, 8}, {0, 0, -1}, 0.7f}, hit));
        const DifferentialGeometry d = g.differential(hit);
        EXPECT_LT(distance(d.angular_velocity, axis * (kPi / 4)), 1e-3f);
        EXPECT_LT(distance(d.velocity, cross(axis * (kPi / 4), hit.position)), 2e-3f);
    }
}

TEST(GeometryMotion, RestingShapesHaveNoVelocity) {
    const AnimatedTransform motion(Transform{}, 0.5f, Transform::translate({1, 0, 0}), 1);
    const Geometry g{scene_of({mesh(probe(), motion)})};
    SurfaceHit hit;
    ASSERT_TRUE(g.intersect({{0, 0, 5}, {0, 0, -1}, 0.2f}, hit));
    EXPECT_EQ(g.differential(hit).velocity, Vec3{});
    ASSERT_TRUE(g.intersect({{0.5f, 0, 5}, {0, 0, -1}, 0.7f}, hit));
    EXPECT_LT(distance(g.differential(hit).velocity, {2, 0, 0}), 1e-3f);
    ASSERT_TRUE(g.intersect({{1, 0, 5}, {0, 0, -1}, 1.0f}, hit));
    EXPECT_LT(distance(g.differential(hit).velocity, {2, 0, 0}), 1e-3f);
}

TEST(GeometryMotion, CoincidentSurfacesGiveTheSameHitForAnyNumberOfThreads) {
    const auto ball = std::make_shared<const TriangleMesh>(sphere_mesh(1, 60, 120));
    const auto hash = [&](int threads) {
        const ThreadLimit limit(threads);
        const Geometry g{scene_of({shape(ball), shape(ball), shape(ball)})};
        Random random(8);
        uint64_t h = 0;
        for (int i = 0; i < 20000; ++i) {
            SurfaceHit hit;
            if (g.intersect({random.in_box(1.5f), random.direction()}, hit))
                h = h * 1000003 + hit.shape * 7919ull + hit.primitive;
        }
        return h;
    };
    const uint64_t one = hash(1);
    EXPECT_EQ(one, hash(2));
    EXPECT_EQ(one, hash(0));
}

}  // namespace
}  // namespace covtrace
