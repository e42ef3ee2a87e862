/// Cones, grids and images over the directions of lights.
#include <gtest/gtest.h>

#include "core/frame.h"
#include "core/rng.h"
#include "core/warp.h"
#include "light/spot_cone.h"
#include "light_fixtures.h"

namespace covtrace {
namespace {

using namespace test;

TEST(SpotCone, GridsLeaveTheShareBetweenTheirSlats) {
    const SpotCone grid = SpotCone::grid(50);
    const float limit = std::tan(50 * kPi / 180);
    double sum = 0;
    constexpr int kSteps = 10000;
    for (int i = 0; i < kSteps; ++i) {
        const double angle = (i + 0.5) / kSteps * M_PI / 2;
        const auto f = grid.falloff(
            {static_cast<float>(std::sin(angle)), 0, static_cast<float>(std::cos(angle))});
        EXPECT_NEAR(f, std::max(0.0, 1 - std::tan(angle) / double(limit)), 1e-6);
        sum += 2 * M_PI * std::sin(angle) * double(f) * (M_PI / 2 / kSteps);
    }
    EXPECT_NEAR(grid.solid_angle(), sum, 1e-4);
    EXPECT_NEAR(SpotCone::grid(90).falloff({std::sqrt(0.75f), 0, 0.5f}), 1, 1e-5f);
    EXPECT_NEAR(SpotCone::grid(90).solid_angle(), 2 * kPi, 1e-3f);
}

TEST(SpotCone, NarrowGridsAreAsPreciseAsDirections) {
    const Vec3 axis = normalize(Vec3{1, 2, 3});
    const Frame frame = Frame::from_z(axis);
    for (const float degrees : {1.0f, 0.1f, 0.01f, 0.001f}) {
        const SpotCone grid = SpotCone::grid(degrees, axis);
        const double outer = double(degrees) * M_PI / 180;
        const auto half = static_cast<float>(outer / 2);
        const Vec3 w = normalize(frame.to_world({std::sin(half), 0, std::cos(half)}));
        EXPECT_NEAR(grid.falloff(w), 1 - std::tan(outer / 2) / std::tan(outer), 2e-7 / outer)
            << degrees;
        EXPECT_NEAR(grid.solid_angle() / (M_PI / 3 * outer * outer), 1, 1e-4) << degrees;
        // Half the mean squared angle, weighted by 1 - t / outer
        EXPECT_NEAR(double(grid.variance()) / (0.15 * outer * outer), 1, 0.01) << degrees;
    }
}

TEST(SpotCone, StretchedConesCountTheAngleBefore) {
    const Transform stretch = Transform::rotate(30, {1, 0, 0}) * Transform::scale(2, 1, 0.5);
    const SpotCone cone = SpotCone::from_degrees(40, 15, stretch),
                   round = SpotCone::from_degrees(40, 15);
    Rng rng(3);
    double sum = 0;
    constexpr int kSamples = 200000;
    for (int i = 0; i < kSamples; ++i) {
        const Vec3 w = square_to_sphere(rng.next_2d());
        const float f = cone.falloff(w);
        EXPECT_NEAR(f, round.falloff(normalize(stretch.inverse().vector(w))), 1e-5f);
        if (f > 0) EXPECT_LE(std::acos(dot(w, cone.axis())), cone.outer_angle() + 1e-4f);
        sum += double(f);
    }
    EXPECT_NEAR(cone.solid_angle() / (sum / kSamples * 4 * M_PI), 1, 0.01);
    EXPECT_FLOAT_EQ(SpotCone::from_degrees(40, 15, Transform::scale(3, 3, 3)).solid_angle(),
                    round.solid_angle());
}

/// As in pbrt-v4: the light is that of the direction before the transform.
TEST(SpotCone, SpotsUnderAStretchHaveAStretchedCone) {
    LightScene s;
    s.add_light(SpotLight{.intensity = Rgb(1),
                          .power = {},
                          .from = {},
                          .to = {0, 0, 1},
                          .cone_angle = 30,
                          .cone_delta_angle = 0},
                Transform::scale(2, 1, 1));
    s.build();
    const auto is_lit = [&s](Vec3 p) {
        return s.lights->sample(p, {}, 0, 0.5f, {0.5f, 0.5f}).has_value();
    };
    const float t = std::tan(kPi / 6);
    EXPECT_TRUE(is_lit({1.9f * t, 0, 1}));
    EXPECT_FALSE(is_lit({2.1f * t, 0, 1}));
    EXPECT_TRUE(is_lit({0, 0.95f * t, 1}));
    EXPECT_FALSE(is_lit({0, 1.05f * t, 1}));
}

TEST(SpotCone, PowerOfAFlatLampWithAGrid) {
    LightScene s;
    s.add(mesh_of(rectangle(2, 2)), Rgb(1));
    s.description.area_lights[0].cone = {.angle = 25, .delta_angle = 0, .is_grid = true};
    s.build();
    // The integral of sin cos (1 - tan / tan(angle)), as the add-on has it for Blender's spread
    const double half = 25 * M_PI / 180, share = (std::tan(half) - half) / std::tan(half);
    EXPECT_NEAR(s.lights->total_power().g / (4 * M_PI * share), 1, 2e-3);
}

/// A ball with an image shines in each direction as a goniometric light of the same image, also
/// within a cone.
TEST(SpotCone, ImagesOverTheDirectionsOfABall) {
    std::vector<Rgb> texels;
    for (int i = 0; i < 64; ++i) texels.emplace_back(Rgb(float(i % 7) + 0.5f));
    const TemporaryImage image(texels, 8, 8);
    const Transform turned = Transform::rotate(40, {1, 2, 0});
    constexpr float kRadius = 0.01f;
    for (const bool has_cone : {false, true}) {
        LightScene ball, point;
        ball.add(shape_of(Sphere{.radius = kRadius, .z_min = -kRadius, .z_max = kRadius},
                          AnimatedTransform(turned)),
                 Rgb(1));
        AreaLightDescription& light = ball.description.area_lights[0];
        light.goniometric = image.path();
        GoniometricLight same{
            .intensity = Rgb(kPi * sqr(kRadius)), .power = {}, .image = image.path()};
        if (has_cone) {
            light.cone = {.angle = 60, .delta_angle = 20};
            same.cone = ConeDescription{60, 20};
        }
        point.add_light(same, turned);
        ball.build();
        point.build();
        EXPECT_NEAR(ball.lights->total_power().g / point.lights->total_power().g, 1, 1e-4);
        Rng rng(5);
        int lit_places = 0;
        for (int i = 0; i < 500; ++i) {
            // Only the middle of the ball shines in exactly the direction of the point light.
            const Vec3 p = square_to_sphere(rng.next_2d()) * 3;
            const auto b = ball.lights->sample(p, {}, 0, 0.5f, {0, 0});
            const auto q = point.lights->sample(p, {}, 0, 0.5f, {0, 0});
            if (!b || !q) continue;
            ++lit_places;
            EXPECT_NEAR(b->radiance.g / b->pdf / q->radiance.g, 1, 0.02) << i;
        }
        EXPECT_GT(lit_places, has_cone ? 50 : 450);
    }
}

}  // namespace
}  // namespace covtrace
