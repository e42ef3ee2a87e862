// Transforms and motion: inverses, pbrt's LookAt, interpolation along circles, velocities.
#include "core/transform.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

namespace covtrace {
namespace {

void expect_near(Vec3 a, Vec3 b, float tolerance) {
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
}

Vec3 random_vector() {
    const auto coordinate = [] { return float(*rc::gen::inRange(-1000, 1001)) * 0.01f; };
    const float x = coordinate(), y = coordinate();
    return {x, y, coordinate()};
}

Transform random_rigid() {
    const Vec3 axis = random_vector() + Vec3{0.001f, 0, 0};
    return Transform::translate(random_vector()) *
           Transform::rotate(*rc::gen::inRange(-170, 171), axis);
}

RC_GTEST_PROP(Transform, InverseUndoes, ()) {
    const Transform t = random_rigid() * Transform::scale(2, -3, 0.5);
    const Vec3 p = random_vector();
    RC_ASSERT(distance(t.inverse().point(t.point(p)), p) < 1e-3f);
    RC_ASSERT(t.swaps_handedness());
}

RC_GTEST_PROP(Transform, NormalsStayOrthogonal, ()) {
    const Transform t = random_rigid() * Transform::scale(2, 0.3, 5);
    const Vec3 n{0, 0, 1}, tangent{0.3f, -0.7f, 0};
    RC_ASSERT(std::abs(dot(t.normal(n), t.vector(tangent))) < 1e-4f);
}

TEST(Transform, SingularMatricesAreRefused) {
    Matrix4 m;
    m.m[1][1] = 0;
    EXPECT_FALSE(Transform::from_matrix(m));
    EXPECT_FALSE(Transform::look_at({0, 0, 0}, {0, 0, 0}, {0, 1, 0}));
    EXPECT_FALSE(Transform::look_at({0, 0, 0}, {0, 1, 0}, {0, 1, 0}));
}

TEST(Transform, LookAtIsLeftHandedWithZForward) {
    const Transform t = *Transform::look_at({0, 0, 5}, {0, 0, 0}, {0, 1, 0});
    expect_near(t.point({0, 0, 0}), {0, 0, 5}, 1e-6f);   // in front, on +z
    expect_near(t.point({0, 1, 5}), {0, 1, 0}, 1e-6f);   // up stays up
    expect_near(t.point({-1, 0, 5}), {1, 0, 0}, 1e-6f);  // seen from +z, world -x is on the right
}

TEST(AnimatedTransform, HalfTurnTracesACircle) {
    const AnimatedTransform motion(Transform(), 0, Transform::rotate(179, {0, 0, 1}), 1);
    for (float t = 0; t <= 1; t += 0.125f) {
        const double angle = 179 * t * 3.14159265358979 / 180;
        expect_near(motion.at(t).point({2, 0, 0}),
                    {float(2 * std::cos(angle)), float(2 * std::sin(angle)), 0}, 1e-5f);
    }
}

TEST(AnimatedTransform, RestsOutsideItsKeys) {
    const AnimatedTransform motion(Transform(), 0.25f, Transform::translate({4, 0, 0}), 0.75f);
    expect_near(motion.at(0).point({}), {0, 0, 0}, 0);
    expect_near(motion.at(0.5f).point({}), {2, 0, 0}, 1e-6f);
    expect_near(motion.at(1).point({}), {4, 0, 0}, 0);
    expect_near(motion.velocity({2, 0, 0}, 0.5f), {8, 0, 0}, 1e-3f);
    expect_near(motion.velocity({4, 0, 0}, 0.9f), {0, 0, 0}, 0);
}

RC_GTEST_PROP(AnimatedTransform, KeysAreReproduced, ()) {
    const Transform scale = Transform::scale(1.5, -2, 0.7);
    const AnimatedTransform motion(random_rigid() * scale, 0, random_rigid() * scale, 1);
    const Vec3 p = random_vector();
    // Inside the interval the decomposition takes over: it must meet the keys at both ends.
    RC_ASSERT(distance(motion.at(1e-6f).point(p), motion.start().point(p)) < 2e-3f);
    RC_ASSERT(distance(motion.at(1 - 1e-6f).point(p), motion.end().point(p)) < 2e-3f);
}

RC_GTEST_PROP(AnimatedTransform, VelocityIsRigidMotion, ()) {
    const AnimatedTransform motion(random_rigid(), 0, random_rigid(), 1);
    const float time = float(*rc::gen::inRange(5, 96)) * 0.01f;
    const Vec3 omega = motion.angular_velocity(time);
    const Vec3 p = random_vector(), q = p + random_vector() * 0.1f;
    // Two points of one body: v(q) - v(p) = omega x (q - p).
    const Vec3 difference = motion.velocity(q, time) - motion.velocity(p, time);
    RC_ASSERT(distance(difference, cross(omega, q - p)) < 2e-2f);
}

RC_GTEST_PROP(AnimatedTransform, MotionBoundsHoldTheBox, ()) {
    const AnimatedTransform motion(random_rigid(), 0, random_rigid(), 1);
    const Bounds3 box{{-1, -2, -3}, {1, 2, 3}};
    const Bounds3 all = motion.motion_bounds(box);
    const float t = float(*rc::gen::inRange(0, 1001)) * 0.001f;
    const Vec3 p = motion.at(t).point({1, -2, 3});
    for (int i = 0; i < 3; ++i) RC_ASSERT(p[i] >= all.lo[i] && p[i] <= all.hi[i]);
}

}  // namespace
}  // namespace covtrace
