// Camera rays: field of view, focus, shutter, and the sensor's linear map against finite
// differences.
#include "camera/camera.h"

#include <gtest/gtest.h>

#include <cmath>

namespace covtrace {
namespace {

CameraDescription description(float lens_radius) {
    CameraDescription d;
    d.camera_to_world =
        AnimatedTransform(Transform::look_at({1, 2, 3}, {4, 1, -6}, {0, 1, 0})->inverse());
    d.fov = 50;
    d.lens_radius = lens_radius;
    d.focal_distance = 4;
    return d;
}

TEST(Camera, FieldOfViewSpansTheShorterAxis) {
    CameraDescription d;
    d.fov = 90;
    const Camera wide(d, 200, 100);
    const Vec3 top = wide.generate_ray({100, 0}, {}, 0).direction;
    EXPECT_NEAR(top.y / top.z, 1, 1e-5f);
    const Vec3 right = wide.generate_ray({200, 50}, {}, 0).direction;
    EXPECT_NEAR(right.x / right.z, 2, 1e-5f);
    const Camera tall(d, 100, 200);
    const Vec3 left = tall.generate_ray({0, 100}, {}, 0).direction;
    EXPECT_NEAR(left.x / left.z, -1, 1e-5f);
}

TEST(Camera, WindowsThatDoNotFillTheFilmAreWidened) {
    CameraDescription d;
    d.kind = CameraDescription::Kind::orthographic;
    d.screen_window = {-2, 2, -1, 1};
    const auto corner = [&](int width, int height) {
        return Camera(d, width, height).generate_ray({float(width), 0}, {}, 0).origin;
    };
    EXPECT_NEAR(corner(100, 100).y, 1, 1e-5f);  // pbrt stretches
    d.window_fills_film = false;
    EXPECT_NEAR(corner(200, 100).x, 2, 1e-5f);
    EXPECT_NEAR(corner(200, 100).y, 1, 1e-5f);
    EXPECT_NEAR(corner(100, 100).x, 2, 1e-5f);
    EXPECT_NEAR(corner(100, 100).y, 2, 1e-5f);
    EXPECT_NEAR(corner(400, 100).x, 4, 1e-5f);
    EXPECT_NEAR(corner(400, 100).y, 1, 1e-5f);
}

TEST(Camera, LensRaysMeetInThePlaneOfFocus) {
    const Camera camera(description(0.3f), 320, 180);
    const Ray a = camera.generate_ray({37, 120}, {0.1f, 0.9f}, 0),
              b = camera.generate_ray({37, 120}, {0.8f, 0.3f}, 0);
    EXPECT_GT(distance(a.origin, b.origin), 0.05f);
    const SensorGeometry g = camera.sensor(a);
    const auto focus = [&](const Ray& r) {
        const Vec3 centre{1, 2, 3};
        const float t = (4 - dot(r.origin - centre, g.forward)) / dot(r.direction, g.forward);
        return r.origin + r.direction * t;
    };
    EXPECT_LT(distance(focus(a), focus(b)), 1e-4f);
}

TEST(Camera, ShutterMapsToTime) {
    CameraDescription d;
    d.shutter_open = 0.2f;
    d.shutter_close = 0.6f;
    const Camera camera(d, 10, 10);
    EXPECT_FLOAT_EQ(camera.generate_ray({5, 5}, {}, 0).time, 0.2f);
    EXPECT_FLOAT_EQ(camera.generate_ray({5, 5}, {}, 0.5f).time, 0.4f);
    EXPECT_FLOAT_EQ(camera.sensor(camera.generate_ray({5, 5}, {}, 0)).shutter, 0.4f);
}

/// The camera ray in terms of the sensor geometry is: origin + R (l1 right + l2 down), slope p - R
/// l / z_f.
TEST(Camera, SensorGeometryPredictsNeighbouringRays) {
    for (bool mirrored : {false, true}) {
        CameraDescription d = description(0.2f);
        if (mirrored) {
            const Transform flip =
                Transform::scale(-1, 1, 1) * *Transform::look_at({1, 2, 3}, {4, 1, -6}, {0, 1, 0});
            d.camera_to_world = AnimatedTransform(flip.inverse());
        }
        const Camera camera(d, 320, 180);
        const Vec2 film{100, 60};
        const Ray ray = camera.generate_ray(film, {0.5f, 0.5f}, 0);
        const SensorGeometry g = camera.sensor(ray);
        const auto slope = [&](const Ray& r) {
            const float z = dot(r.direction, g.forward);
            return Vec2{dot(r.direction, g.right) / z, dot(r.direction, g.down) / z};
        };
        const Ray next = camera.generate_ray({film.x + 1, film.y + 2}, {0.5f, 0.5f}, 0);
        EXPECT_NEAR((slope(next).x - slope(ray).x) * g.pixels_per_x, 1, 1e-3f);
        EXPECT_NEAR((slope(next).y - slope(ray).y) * g.pixels_per_y, 2, 1e-3f);
        const Ray lens = camera.generate_ray(film, {0.9f, 0.5f}, 0);
        const float l = dot(lens.origin - ray.origin, g.right);
        EXPECT_NEAR(slope(lens).x - slope(ray).x, -l / g.focal_distance, 1e-4f);
    }
}

TEST(Camera, HalfAPixelIsThatOfTheWorldUnderAnyScale) {
    for (const auto kind :
         {CameraDescription::Kind::perspective, CameraDescription::Kind::orthographic})
        for (double scale : {0.02, 1.0, 50.0}) {
            CameraDescription d;
            d.kind = kind;
            d.fov = 1;
            d.camera_to_world = AnimatedTransform(Transform::scale(scale, scale, scale));
            const Camera camera(d, 100, 100);
            const Ray a = camera.generate_ray({50, 50}, {}, 0),
                      b = camera.generate_ray({50.5f, 50}, {}, 0);
            constexpr float kFar = 7;
            const float apart =
                distance(a.origin + a.direction * kFar, b.origin + b.direction * kFar);
            EXPECT_NEAR(camera.half_pixel(kFar) / apart, 1, 1e-3f) << "scale " << scale;
        }
}

TEST(Camera, WorldToNdcAgreesWithRays) {
    const Camera camera(description(0), 320, 180);
    const Ray ray = camera.generate_ray({80, 135}, {}, 0);
    const Vec3 p = ray.origin + ray.direction * 3;
    const Vec3 ndc = Transform(camera.world_to_ndc(), Matrix4{}).point(p);
    EXPECT_NEAR(ndc.x * 320, 80, 1e-2f);
    EXPECT_NEAR(ndc.y * 180, 135, 1e-2f);
}

TEST(Camera, MovingCameraHasItsVelocity) {
    CameraDescription d;
    d.camera_to_world = AnimatedTransform(
        Transform(), 0, Transform::translate({2, 0, 0}) * Transform::rotate(30, {0, 1, 0}), 1);
    const Camera camera(d, 10, 10);
    const SensorGeometry g = camera.sensor(camera.generate_ray({5, 5}, {}, 0.5f));
    EXPECT_NEAR(g.velocity.x, 2, 1e-2f);
    EXPECT_NEAR(g.angular_velocity.y, 30 * kPi / 180, 1e-3f);
}

TEST(Camera, TurningByHalfATurnFollowsACircle) {
    // The camera turns on the spot, by an angle in proportion to time; either way round.
    CameraDescription d;
    d.camera_to_world = AnimatedTransform(Transform(), 0, Transform::rotate(180, {0, 1, 0}), 1);
    const Camera camera(d, 10, 10);
    const float side = camera.generate_ray({5, 5}, {}, 0.5f).direction.x > 0 ? 1.0f : -1.0f;
    for (int i = 0; i <= 40; ++i) {
        const float t = float(i) / 40;
        const Vec3 w = camera.generate_ray({5, 5}, {}, t).direction;
        const Vec3 exact = Transform::rotate(180 * t, {0, 1, 0}).vector({0, 0, 1});
        EXPECT_LT(distance(w, {side * exact.x, exact.y, exact.z}), 1e-6f) << t;
    }
}

}  // namespace
}  // namespace covtrace
