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

TEST(AnimatedTransform, AScaleBeforeARotationIsInterpolatedAsInPbrt) {
    // `Scale 2 1 1  Rotate 45 0 0 1` at the end, `Scale 2 1 1` at the start: the polar stretches
    // are diag(2, 1) and R^T diag(2, 1) R = ((1.5, -0.5), (-0.5, 1.5)), and R turns by 45 degrees.
    const Transform scale = Transform::scale(2, 1, 1);
    const AnimatedTransform motion(scale, 0, scale * Transform::rotate(45, {0, 0, 1}), 1);
    const Transform turn = Transform::rotate(22.5, {0, 0, 1});
    expect_near(motion.at(0.5f).point({1, 0, 0}), turn.point({1.75f, -0.25f, 0}), 1e-6f);
    expect_near(motion.at(0.5f).point({0, 1, 0}), turn.point({-0.25f, 1.25f, 0}), 1e-6f);
    expect_near(motion.at(0.5f).point({0, 0, 1}), {0, 0, 1}, 1e-6f);
}

/// A symmetric stretch along random axes by factors of one sign.
Transform random_stretch(double sign) {
    const auto factor = [&] { return sign * *rc::gen::inRange(1, 1000) * 0.01; };
    const double x = factor(), y = factor();
    const Transform axes =
        Transform::rotate(*rc::gen::inRange(0, 360), random_vector() + Vec3{0.001f, 0, 0});
    return axes * Transform::scale(x, y, factor()) * axes.inverse();
}

RC_GTEST_PROP(AnimatedTransform, RotationsAndSymmetricStretchesAreInterpolatedApart, ()) {
    // The factors of the keys are those that the decomposition has to find; a reflection is the
    // opposite of a rotation.
    const double sign = *rc::gen::element(1.0, -1.0);
    const Vec3 axis = random_vector() + Vec3{0.001f, 0, 0};
    const double degrees = *rc::gen::inRange(-170, 171);
    const Vec3 from = random_vector(), to = random_vector();
    const Transform first = Transform::rotate(*rc::gen::inRange(0, 360), random_vector() + axis);
    const Transform a = random_stretch(sign), b = random_stretch(sign);
    const AnimatedTransform motion(
        Transform::translate(from) * first * a, 2,
        Transform::translate(to) * Transform::rotate(degrees, axis) * first * b, 4);
    const float t = float(*rc::gen::inRange(1, 1000)) * 0.001f;
    Matrix4 stretch;
    for (size_t i = 0; i < 3; ++i)
        for (size_t j = 0; j < 3; ++j)
            stretch.m[i][j] = (1 - t) * a.matrix().m[i][j] + t * b.matrix().m[i][j];
    const Vec3 p = random_vector();
    const Vec3 expected =
        from * (1 - t) + to * t +
        (Transform::rotate(degrees * t, axis) * first * *Transform::from_matrix(stretch)).vector(p);
    RC_ASSERT(distance(motion.at(2 + 2 * t).point(p), expected) < 1e-4f * (1 + length(expected)));
}

RC_GTEST_PROP(AnimatedTransform, TheRateIsTheDerivative, ()) {
    const AnimatedTransform motion(random_rigid() * random_stretch(1), 1,
                                   random_rigid() * random_stretch(1), 2);
    const float time = 1 + float(*rc::gen::inRange(1, 127)) / 128;
    constexpr float kStep = 1.0f / 1024;
    const Matrix4 before = motion.matrix_at(time - kStep), after = motion.matrix_at(time + kStep);
    const Matrix4 rate = motion.rate(time);
    for (size_t i = 0; i < 3; ++i)
        for (size_t j = 0; j < 4; ++j)
            RC_ASSERT(std::abs((after.m[i][j] - before.m[i][j]) / (2 * kStep) - rate.m[i][j]) <
                      1e-3);
}

RC_GTEST_PROP(AnimatedTransform, KeysAreReproduced, ()) {
    const Transform scale = Transform::scale(1.5, -2, 0.7);
    const AnimatedTransform motion(random_rigid() * scale, 0, random_rigid() * scale, 1);
    const Vec3 p = random_vector();
    // The decomposition takes over inside the interval: it must meet the keys at both ends.
    RC_ASSERT(distance(motion.at(1e-6f).point(p), motion.start().point(p)) < 2e-3f);
    RC_ASSERT(distance(motion.at(1 - 1e-6f).point(p), motion.end().point(p)) < 2e-3f);
}

RC_GTEST_PROP(AnimatedTransform, VelocityIsRigidMotion, ()) {
    const AnimatedTransform motion(random_rigid(), 0, random_rigid(), 1);
    const float time = float(*rc::gen::inRange(5, 96)) * 0.01f;
    const Vec3 omega = motion.angular_velocity(time);
    const Vec3 p = random_vector(), q = p + random_vector() * 0.1f;
    // Two points of one body obey v(q) - v(p) = omega x (q - p).
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
