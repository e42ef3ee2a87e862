/// Monte-Carlo irradiance by light sampling against closed forms, and how little it varies.
///
/// The z-tests together alarm falsely with probability 0.01, corrected after Šidák, on fixed seeds.
#include <gtest/gtest.h>

#include <functional>

#include "../unit/light_fixtures.h"
#include "core/rng.h"
#include "light/environment_map.h"

namespace covtrace {
namespace {

using namespace test;

/// Irradiance of a polygon of radiance 1 that lies above the horizon (Lambert 1760).
double polygon_irradiance(const std::vector<Vec3>& corners, Vec3 p, Vec3 n) {
    double sum = 0;
    for (size_t i = 0; i < corners.size(); ++i) {
        const Vec3 a = normalize(corners[i] - p),
                   b = normalize(corners[(i + 1) % corners.size()] - p);
        const Vec3 axis = cross(a, b);
        sum += std::atan2(length(axis), dot(a, b)) * double(dot(normalize(axis), n));
    }
    return std::abs(sum) / 2;
}

struct Irradiance {
    std::string name;
    std::function<void(LightScene&)> make;
    Vec3 p, n;
    double expected;
};
std::ostream& operator<<(std::ostream& out, const Irradiance& c) {
    return out << c.name;
}

std::vector<Irradiance> all_irradiances() {
    const Vec3 up{0, 0, 1};
    const Transform over = Transform::rotate(180, {1, 0, 0});
    const auto at = [](Vec3 p) { return Transform::translate(p); };
    const auto add = [](ShapeDescription shape) {
        return [shape](LightScene& s) { s.add(shape, Rgb(3)); };
    };
    const auto corners = [](Vec3 center, float a, float b) {
        const Vec3 x{a / 2, 0, 0}, y{0, b / 2, 0};
        return std::vector<Vec3>{center - x - y, center + x - y, center + x + y, center - x + y};
    };
    const Vec3 tilted = normalize(Vec3{0.3f, -0.2f, 0.9f});
    std::vector<Irradiance> cases = {
        {"rectangle", add(mesh_of(rectangle(2, 1), placed({at({0.5f, 0, 2}), over}))), {}, tilted,
         3 * polygon_irradiance(corners({0.5f, 0, 2}, 2, 1), {}, tilted)},
        {"rectangle_near", add(mesh_of(rectangle(2, 1), placed({at({0.2f, 0.1f, 0.1f}), over}))), {}, up,
         3 * polygon_irradiance(corners({0.2f, 0.1f, 0.1f}, 2, 1), {}, up)},
        {"patch", add(patch_of({-1, -1, 2}, {-1, 1, 2}, {1, -1, 2}, {1, 1, 2})), {}, up,
         3 * polygon_irradiance(corners({0, 0, 2}, 2, 2), {}, up)},
        {"trapezium", add(patch_of({-1, -1, 2}, {-0.3f, 1, 2}, {1, -1, 2}, {0.3f, 1, 2})), {}, up,
         3 * polygon_irradiance({{-1, -1, 2}, {1, -1, 2}, {0.3f, 1, 2}, {-0.3f, 1, 2}}, {}, up)},
        {"sphere", add(shape_of(whole_sphere(0.5f), placed({at({1, 0, 3}), Transform::scale(2, 2, 2)}))), {}, up,
         3 * double(kPi) / 10 * 3 / std::sqrt(10.0)},
        {"sphere_around", [](LightScene& s) { s.add(shape_of(whole_sphere(4)), Rgb(3), true); }, {1, 2, -1}, tilted,
         3 * double(kPi)},
        {"disk", add(shape_of(Disk{0, 1.5f, 0, 360}, placed({at({0, 0, 2}), over}))), {}, up,
         3 * double(kPi) * 2.25 / (2.25 + 4)},
        {"ring", add(shape_of(Disk{2, 1.5f, 1, 360}, placed({Transform::scale(1, 1, -1), at({0, 0, -4})}))), {}, up,
         3 * double(kPi) * (2.25 / (2.25 + 4) - 1 / (1.0 + 4))},
        {"uniform_sky", [](LightScene& s) { s.add_light(InfiniteLight{.radiance = Rgb(3), .image = {}, .illuminance = {}}); }, {}, tilted,
         3 * double(kPi)},
        {"gradient_from_above", [](LightScene& s) { s.add_light(InfiniteLight{.radiance = Rgb(3), .gradient = HeightGradient{1, 1.1f, 1.2f}}); }, {}, up,
         // The sky of a level a and a top b: integral of 2 pi (a + (b - a) s) s over the sine s. All of the
         // sky is so bright that directions are drawn there
         3 * double(kPi) * (1.1 + 2 * 1.2) / 3},
        {"gradient_from_below", [](LightScene& s) { s.add_light(InfiniteLight{.radiance = Rgb(3), .gradient = HeightGradient{1, 1.1f, 1.2f}}); }, {}, Vec3{0, 0, -1},
         3 * double(kPi) * (1.1 + 2 * 1.0) / 3},
        {"illuminance_of_sky", [](LightScene& s) { s.add_light(InfiniteLight{.radiance = Rgb(7), .image = {}, .illuminance = 42.0f}); }, {},
         tilted, 42},
        {"portal", [=](LightScene& s) {
             const auto c = corners({0.5f, 0, 2}, 2, 1);
             s.add_light(InfiniteLight{.radiance = Rgb(3), .image = {}, .illuminance = {}, .portal = {{c[0], c[3], c[2], c[1]}}});
         }, {}, tilted, 3 * polygon_irradiance(corners({0.5f, 0, 2}, 2, 1), {}, tilted)},
        {"portal_from_behind", [=](LightScene& s) {
             const auto c = corners({0.5f, 0, 2}, 2, 1);
             s.add_light(InfiniteLight{.radiance = Rgb(3), .image = {}, .illuminance = {}, .portal = {{c[0], c[1], c[2], c[3]}}});
         }, {}, up, 0},
        {"distant", [](LightScene& s) { s.add_light(DistantLight{.radiance = Rgb(3), .direction = {0.6f, 0, 0.8f}}); }, {}, up, 2.4},
        {"sun", [](LightScene& s) { s.add_light(DistantLight{.radiance = Rgb(3), .direction = {0.6f, 0, 0.8f}, .angle = 0.53f}); }, {}, up, 2.4},
        {"wide_sun", [](LightScene& s) { s.add_light(DistantLight{.radiance = Rgb(3), .direction = {0.6f, 0, 0.8f}, .angle = 100}); }, {}, up, 2.4},
        {"half_a_sky_of_sun", [](LightScene& s) { s.add_light(DistantLight{.radiance = Rgb(3), .direction = {1, 0, 0}, .angle = 180}); }, {}, up, 1.5},
        {"point", [](LightScene& s) { s.add_light(PointLight{.intensity = Rgb(3), .power = {}, .from = {3, 0, 4}}); }, {}, up, 3.0 / 25 * 0.8},
        {"point_power", [](LightScene& s) { s.add_light(PointLight{.intensity = Rgb(3), .power = 100.0f, .from = {0, 0, 4}}); }, {}, up,
         100 / (4 * double(kPi)) / 16},
        {"spot_axis", [](LightScene& s) {
             s.add_light(SpotLight{.intensity = Rgb(3), .power = {}, .from = {0, 0, 4}, .to = {0, 0, 0}});
         }, {}, up, 3.0 / 16},
        {"spot_outside", [](LightScene& s) {
             s.add_light(SpotLight{.intensity = Rgb(3), .power = {}, .from = {0, 0, 4}, .to = {4, 0, 0}});
         }, {}, up, 0},
        {"soft_spot", [=](LightScene& s) {
             s.add(shape_of(whole_sphere(0.5f), placed({at({0, 0, 4}), over})), Rgb(3));
             s.description.area_lights.back().cone = {30, 5};
         }, {}, up, 3 * double(kPi) / 64},
        {"outside_of_a_soft_spot", [=](LightScene& s) {
             s.add(shape_of(whole_sphere(0.5f), placed({at({4, 0, 4}), over})), Rgb(3));
             s.description.area_lights.back().cone = {30, 5};
         }, {}, up, 0},
        {"all_of_them", [=](LightScene& s) {
             s.add(mesh_of(rectangle(2, 1), placed({at({0.5f, 0, 2}), over})), Rgb(3));
             s.add(shape_of(whole_sphere(0.5f), placed({at({4, 0, 12}), Transform::scale(2, 2, 2)})), Rgb(3));
             s.add_light(DistantLight{.radiance = Rgb(3), .direction = {0.6f, 0, 0.8f}});
             s.add_light(DistantLight{.radiance = Rgb(3), .direction = {0.6f, 0, 0.8f}, .angle = 5});
             s.add_light(PointLight{.intensity = Rgb(3), .power = {}, .from = {3, 0, 4}});
             s.add_light(InfiniteLight{.radiance = Rgb(3), .image = {}, .illuminance = {}});
             s.add_light(InfiniteLight{.radiance = Rgb(1), .image = {}, .illuminance = {}});
         }, {}, up, 3 * polygon_irradiance(corners({0.5f, 0, 2}, 2, 1), {}, up) +
                   3 * double(kPi) / 160 * 12 / std::sqrt(160.0) + 4.8 + 3.0 / 25 * 0.8 + 4 * double(kPi)},
    };
    return cases;
}

class LightIrradiance : public testing::TestWithParam<Irradiance> {};

TEST_P(LightIrradiance, MatchesTheClosedForm) {
    const Irradiance& c = GetParam();
    LightScene s;
    c.make(s);
    s.build();
    Rng rng(31);
    constexpr int kSamples = 200000;
    double sum = 0, square = 0;
    for (int i = 0; i < kSamples; ++i) {
        const float u = rng.next_float();
        const auto sample = s.lights->sample(c.p, c.n, 0, u, rng.next_2d());
        if (!sample) continue;
        const double v = double(luminance(sample->radiance)) *
                         std::max(0.0f, dot(sample->wi, c.n)) / sample->pdf;
        sum += v;
        square += v * v;
    }
    const double mean = sum / kSamples, variance = square / kSamples - mean * mean;
    // 26 two-sided tests at 0.01 in total: 3.55 standard deviations; float arithmetic may add 1e-4.
    EXPECT_NEAR(mean, c.expected,
                3.55 * std::sqrt(std::max(0.0, variance) / kSamples) + 1e-4 * c.expected);
}

INSTANTIATE_TEST_SUITE_P(Lights, LightIrradiance, testing::ValuesIn(all_irradiances()),
                         [](const auto& test) { return test.param.name; });

// ---- Variance

/// Relative variance of one sample of the luminous irradiance.
double relative_variance(const LightScene& s, Vec3 p, Vec3 n, uint64_t seed) {
    Rng rng(seed);
    constexpr int kSamples = 20000;
    double sum = 0, square = 0;
    for (int i = 0; i < kSamples; ++i) {
        const float u = rng.next_float();
        const auto sample = s.lights->sample(p, n, 0, u, rng.next_2d());
        if (!sample) continue;
        const double v =
            double(luminance(sample->radiance)) * std::max(0.0f, dot(sample->wi, n)) / sample->pdf;
        sum += v;
        square += v * v;
    }
    return square * kSamples / (sum * sum) - 1;
}

TEST(LightTreeQuality, BeatsUniformSelectionAmongScatteredLights) {
    LightScene s;
    Rng rng(37);
    for (int i = 0; i < 64; ++i) {
        const Vec3 at{10 * rng.next_float(), 10 * rng.next_float(), 0.5f + rng.next_float()};
        s.add(shape_of(whole_sphere(0.05f), AnimatedTransform(Transform::translate(at))),
              Rgb(1 + 9 * rng.next_float()));
    }
    s.build();
    double ours = 0, uniform = 0;
    for (int i = 0; i < 50; ++i) {
        const Vec3 p{10 * rng.next_float(), 10 * rng.next_float(), 0}, n{0, 0, 1};
        ours += relative_variance(s, p, n, uint64_t(i));
        // Uniform selection is compared with, where the sampling of each sphere is exact: only the
        // sum over lights varies.
        double sum = 0, square = 0;
        for (size_t k = 0; k < 64; ++k) {
            const Vec3 d = s.description.shapes[k].object_to_world.start().point({}) - p;
            const double e = double(luminance(s.description.area_lights[k].radiance)) * d.z /
                             std::pow(length(d), 3);
            sum += e;
            square += e * e;
        }
        uniform += 64 * square / (sum * sum) - 1;
    }
    EXPECT_LT(ours, 0.25 * uniform) << ours / 50 << " against " << uniform / 50;
}

TEST(EnvironmentQuality, ASunOfOneTexelCostsNoVariance) {
    // The mean over the sphere of the radiance that directions are drawn for, estimated by its own
    // density: constant but for rows on lat-long maps.
    for (int width : {64, 128}) {
        const EnvironmentMap map(sky_with_sun(width, 64, 20, 17, 1e6f), width, 64);
        const auto channels_mean = [](Rgb c) { return double(c.r + c.g + c.b) / 3; };
        const double whole = channels_mean(map.mean());
        Rng rng(41);
        double sum = 0, square = 0;
        constexpr int kSamples = 100000;
        for (int i = 0; i < kSamples; ++i) {
            const Vec3 w = map.sample(rng.next_2d());
            const double drawn =
                channels_mean(map.radiance(w)) - double(EnvironmentMap::kLeftOut) * whole;
            const double v = std::max(0.0, drawn) / map.pdf(w);
            sum += v;
            square += v * v;
        }
        const double mean = sum / kSamples;
        EXPECT_LT(square / kSamples / (mean * mean) - 1, width == 64 ? 1e-4 : 5e-3);
        EXPECT_NEAR(mean / (4 * double(kPi)) / (double(map.drawn_share()) * whole), 1,
                    width == 64 ? 1e-3 : 2e-3);
    }
}

}  // namespace
}  // namespace covtrace
