// Rays and transforms out of all range: Embree's assertions must never see them.
#include <gtest/gtest.h>

#include <limits>

#include "geometry_fixtures.h"

namespace covtrace {
namespace {

using namespace test;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

SceneDescription instanced(const Transform& placed) {
    SceneDescription scene = scene_of({mesh(unit_triangle())});
    scene.objects.push_back({"o", {mesh(unit_triangle())}});
    InstanceDescription instance;
    instance.object = 0;
    instance.instance_to_world = AnimatedTransform(placed);
    scene.instances.push_back(instance);
    return scene;
}

TEST(GeometryRange, RaysThatAreNoRaysMeetNothing) {
    const Geometry g{scene_of({mesh(unit_triangle())})};
    SurfaceHit hit;
    for (const Vec3 bad :
         {Vec3{kNan, 0, 0}, Vec3{0, kInfinity, 0}, Vec3{0, 0, 1e19f}, Vec3{-3e38f, 0, 0}}) {
        EXPECT_FALSE(g.intersect({bad, {0, 0, -1}}, hit));
        EXPECT_FALSE(g.occluded({bad, {0, 0, -1}}));
        EXPECT_FALSE(g.intersect({{0.25f, 0.25f, 1}, bad}, hit));
        EXPECT_FALSE(g.occluded({{0.25f, 0.25f, 1}, bad}));
    }
    EXPECT_FALSE(g.occluded({{0.25f, 0.25f, 1}, {0, 0, -1}, 0, kNan}));
    EXPECT_TRUE(g.intersect({{0.25f, 0.25f, 1e6f}, {0, 0, -1}}, hit));
}

TEST(GeometryRange, InstancesLimitWhereRaysMayStart) {
    // The origin is 1e10 times as far away in the space of the instance.
    const Geometry g{instanced(Transform::scale(1e-10, 1e-10, 1e-10))};
    SurfaceHit hit;
    EXPECT_TRUE(g.intersect({{0.25f, 0.25f, 1e4f}, {0, 0, -1}}, hit));
    EXPECT_FALSE(g.intersect({{0.25f, 0.25f, 1e12f}, {0, 0, -1}}, hit));
}

TEST(GeometryRange, InstancesOutOfReachAreRefused) {
    for (const Transform& t : {Transform::scale(1e-15, 1, 1), Transform::translate({1e19f, 0, 0}),
                               Transform::scale(1, 1, 1e-30)})
        try {
            const Geometry g{instanced(t)};
            FAIL() << "accepted";
        } catch (const Error& e) {
            EXPECT_EQ(e.kind(), ErrorKind::scene);
        }
}

}  // namespace
}  // namespace covtrace
