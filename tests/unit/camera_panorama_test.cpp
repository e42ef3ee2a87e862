/// Panoramas and fisheyes: where directions lie on the film, and back.
#include "camera/panorama.h"

#include <gtest/gtest.h>

#include <cmath>

#include "camera/camera.h"

namespace covtrace::test {
namespace {

using Mapping = CameraDescription::Mapping;
constexpr int kWidth = 160, kHeight = 90;

CameraDescription panorama(Mapping mapping, float fov = 180) {
    CameraDescription d;
    d.kind = CameraDescription::Kind::spherical;
    d.mapping = mapping;
    d.fov = fov;
    return d;
}

/// Degrees between a ray and the camera's axis.
float angle_to_axis(const Camera& camera, Vec2 film) {
    return std::acos(camera.generate_ray(film, {}, 0).direction.z) * 180 / kPi;
}

TEST(Panorama, FisheyesHaveTheirAnglesAtTheirRadii) {
    // The circle fits the film's shorter side: its radius is 45 pixels.
    const Camera even(panorama(Mapping::equidistant, 180), kWidth, kHeight);
    EXPECT_NEAR(angle_to_axis(even, {80, 45}), 0, 0.05);
    EXPECT_NEAR(angle_to_axis(even, {80, 22.5f}), 45, 0.01);
    EXPECT_NEAR(angle_to_axis(even, {125, 45}), 90, 0.01);
    const Vec3 above = even.generate_ray({80, 22.5f}, {}, 0).direction;
    EXPECT_GT(above.y, 0.7f);
    EXPECT_GT(even.generate_ray({100, 45}, {}, 0).direction.x, 0);
    // Circles of half and of the whole area hold half and all of the solid angle.
    const Camera solid(panorama(Mapping::equisolid, 220), kWidth, kHeight);
    const auto solid_angle = [](float degrees) { return 1 - std::cos(degrees * kPi / 180); };
    const float half = angle_to_axis(solid, {80 + 45 * std::sqrt(0.5f), 45});
    EXPECT_NEAR(solid_angle(half), solid_angle(110) / 2, 1e-4);
    EXPECT_NEAR(angle_to_axis(solid, {80, 0}), 110, 0.01);
}

TEST(Panorama, FisheyesSeeNothingBesideTheirCircle) {
    for (const Mapping mapping : {Mapping::equidistant, Mapping::equisolid}) {
        const Camera camera(panorama(mapping), kWidth, kHeight);
        EXPECT_TRUE(camera.generate_ray({124, 45}, {}, 0).sees);
        const CameraRay outside = camera.generate_ray({126, 45}, {}, 0);
        EXPECT_FALSE(outside.sees);
        EXPECT_EQ(outside.weight, 0);
        CameraDescription wide = panorama(mapping);
        wide.screen_window = {-0.5f, 0.5f, -0.25f, 0.25f};
        EXPECT_TRUE(Camera(wide, kWidth, kHeight).generate_ray({0, 0}, {}, 0).sees);
    }
}

TEST(Panorama, DirectionsHaveTheirPlaceOnTheFilm) {
    CameraDescription part = panorama(Mapping::equirectangular);
    part.sphere_part = {0.2f, 0.7f, 0.1f, 0.6f};
    for (const CameraDescription& d :
         {panorama(Mapping::equal_area), panorama(Mapping::equirectangular), part,
          panorama(Mapping::equidistant, 300), panorama(Mapping::equisolid, 300)}) {
        const Panorama map(d, kWidth, kHeight, {-16.0f / 9, 1}, {2.0f / kHeight, -2.0f / kHeight});
        for (const Vec2 film : {Vec2{60, 20}, Vec2{100, 70}, Vec2{80.5f, 45.5f}, Vec2{43, 44}}) {
            const Vec3 w = map.direction(film);
            EXPECT_NEAR(length(w), 1, 1e-5f);
            const Vec2 back = map.film(w);
            EXPECT_NEAR(back.x, film.x, 0.01f) << int(d.mapping);
            EXPECT_NEAR(back.y, film.y, 0.01f) << int(d.mapping);
        }
    }
}

TEST(Panorama, PartsOfTheSphereAreThoseOfTheWhole) {
    const Panorama whole(panorama(Mapping::equirectangular), 200, 100, {}, {});
    CameraDescription d = panorama(Mapping::equirectangular);
    d.sphere_part = {0.25f, 0.5f, 0.5f, 1};
    const Panorama part(d, 50, 50, {}, {});
    for (const Vec2 film : {Vec2{3, 4}, Vec2{40, 22}})
        EXPECT_NEAR(distance(part.direction(film), whole.direction(film + Vec2{50, 50})), 0, 1e-5f);
    EXPECT_NEAR(part.pixel_angle(), whole.pixel_angle(), 1e-6f);
}

TEST(Panorama, SensorOfAFisheyeHasItsScaleThere) {
    const Camera camera(panorama(Mapping::equidistant, 180), kWidth, kHeight);
    for (const Vec2 film : {Vec2{80.25f, 45.5f}, Vec2{110, 50}}) {
        const CameraRay ray = camera.generate_ray(film, {}, 0);
        const SensorGeometry g = camera.sensor(ray);
        const Vec3 beside = camera.generate_ray(film + Vec2{1, 0}, {}, 0).direction;
        const Vec2 moved{dot(beside, g.right) * g.pixels_per_x,
                         dot(beside, g.down) * g.pixels_per_y};
        EXPECT_NEAR(moved.x, 1, 0.02f);
        EXPECT_NEAR(moved.y, 0, 0.05f);
    }
}

}  // namespace
}  // namespace covtrace::test
