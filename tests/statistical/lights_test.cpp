/// Light sampling against densities and closed forms.
///
/// The chi-square tests of directions together alarm falsely with probability 0.01, and so do the
/// z-tests of irradiance; both are corrected after Šidák and run on fixed seeds. Samples that fail
/// are a cell of their own, so that the integral of the density is tested too.
#include <gtest/gtest.h>

#include <functional>

#include "../unit/light_fixtures.h"
#include "chi_square.h"
#include "core/rng.h"
#include "core/warp.h"

namespace covtrace {
namespace {

using namespace test;

/// A scene of lights, the place that it is looked at from, and the cone that its lights lie in.
struct Case {
    std::string name;
    std::function<void(LightScene&)> make;
    Vec3 p, n;
    Vec3 axis{0, 0, 1};
    float cone_degrees = 180;
    float time = 0;
    /// Whether every light shines in all directions.
    bool looks_everywhere() const {
        return name.find("sphere") == 0 || name.find("sky") != std::string::npos ||
               name.find("map") != std::string::npos;
    }
};
std::ostream& operator<<(std::ostream& out, const Case& c) {
    return out << c.name;
}

const TemporaryImage& square_map() {
    static const TemporaryImage image(sky_with_sun(32, 32, 9, 20, 50), 32, 32);
    return image;
}
const TemporaryImage& lat_long_map() {
    static const TemporaryImage image(sky_with_sun(64, 32, 9, 10, 50), 64, 32);
    return image;
}

std::vector<Case> all_cases() {
    const auto up = Vec3{0, 0, 1};
    const auto lamp = [](auto shape, bool two_sided = false) {
        return [shape, two_sided](LightScene& s) { s.add(shape, Rgb(2, 1, 0.5f), two_sided); };
    };
    const Transform above = Transform::translate({0, 0, 2}),
                    over = Transform::rotate(180, {1, 0, 0});
    const auto sky = [](const TemporaryImage& image, const Transform& t) {
        return [&image, t](LightScene& s) {
            InfiniteLight light;
            light.image = image.path();
            s.add_light(light, t);
        };
    };
    const Vec3 slanted{0.6f, 0, 0.8f};
    const auto sun = [slanted](float angle) {
        return [slanted, angle](LightScene& s) {
            s.add_light(DistantLight{.direction = slanted, .angle = angle});
        };
    };
    const Transform tilted = Transform::rotate(50, {1, 2, 3});
    const auto portal = [](const TemporaryImage* image, const Transform& t) {
        InfiniteLight light;
        if (image) light.image = image->path();
        light.portal = {{{-1, -0.5f, 2}, {-1, 0.5f, 2}, {1, 0.5f, 2}, {1, -0.5f, 2}}};
        return [light, t](LightScene& s) { s.add_light(light, t); };
    };
    const Sphere bowl{1, -1, 0.3f, 250};
    const Disk ring{0, 1, 0.4f, 300};
    AnimatedTransform moving(
        Transform::translate({-1, 0, 2}) * over, 0,
        Transform::translate({1, 0.5f, 2.5f}) * Transform::rotate(60, {0, 0, 1}) * over, 1);
    return {
        {"rectangle",
         lamp(mesh_of(rectangle(2, 1), placed({above, over}))),
         {0.3f, 0, 0},
         up,
         up,
         50},
        {"rectangle_from_the_side",
         lamp(mesh_of(rectangle(2, 1), placed({above, over}))),
         {4, 1, 1.5f},
         {-1, 0, 0},
         {-1, -0.25f, 0.13f},
         14},
        {"rectangle_close",
         lamp(mesh_of(rectangle(2, 1), placed({above, over}))),
         {0, 0.2f, 1.9f},
         up,
         up,
         88},
        {"rectangle_far",
         lamp(mesh_of(rectangle(2, 1), placed({above, over}))),
         {60, 10, -100},
         up,
         {-60, -10, 102},
         0.8f},
        {"rectangle_two_sided",
         lamp(mesh_of(rectangle(2, 1), placed({above})), true),
         {0.3f, 0, 0},
         {},
         up,
         50},
        {"rectangle_moving", lamp(mesh_of(rectangle(2, 1), moving)), {0, 0, 0}, up, up, 60, 0.3f},
        {"cube",
         lamp(mesh_of(cube(), placed({Transform::rotate(30, {1, 1, 0})}))),
         {3, 1, 2},
         {},
         {-3, -1, -2},
         35},
        {"parallelogram",
         lamp(patch_of({-1, -1, 2}, {-0.5f, 1, 2}, {1, -1, 2.5f}, {1.5f, 1, 2.5f})),
         {0, 0, 0},
         up,
         up,
         55},
        {"twisted_patch",
         lamp(patch_of({-1, -1, 2}, {-1, 1, 2.4f}, {1, -1, 2.2f}, {1.4f, 1, 1.9f})),
         {0, 0, 0},
         up,
         up,
         55},
        {"trapezium",
         lamp(patch_of({-1, -1, 2}, {-0.3f, 1, 2}, {1, -1, 2}, {0.3f, 1, 2})),
         {0, 0, 0},
         up,
         up,
         55},
        {"sphere",
         lamp(shape_of(whole_sphere(1), placed({Transform::translate({1, 1, 3})}))),
         {0, 0, 0},
         up,
         {1, 1, 3},
         25},
        {"sphere_scaled",
         lamp(shape_of(whole_sphere(1),
                       placed({Transform::translate({1, 1, 3}), Transform::scale(0.5, 0.5, 0.5)}))),
         {0, 0, 0},
         up,
         {1, 1, 3},
         12},
        {"sphere_far",
         lamp(shape_of(whole_sphere(1), placed({Transform::translate({100, 100, 300})}))),
         {0, 0, 0},
         up,
         {1, 1, 3},
         0.3f},
        {"sphere_touching",
         lamp(shape_of(whole_sphere(1), placed({Transform::translate({0, 0, 1.001f})}))),
         {0, 0, 0},
         {},
         up,
         90},
        {"sphere_from_inside",
         lamp(shape_of(whole_sphere(1)), true),
         {0.3f, 0.2f, -0.4f},
         {},
         up,
         180},
        {"ellipsoid",
         lamp(shape_of(whole_sphere(1), placed({Transform::translate({0, 0, 3}), tilted,
                                                Transform::scale(1, 0.4, 0.7)}))),
         {0, 0, 0},
         up,
         up,
         20},
        {"bowl",
         lamp(shape_of(bowl, placed({Transform::translate({0, 0, -3})}))),
         {3, 1, -3.5f},
         {},
         {-3, -1, 0.5f},
         19},
        {"disk",
         lamp(shape_of(Disk{0, 1, 0, 360}, placed({above, over}))),
         {0.5f, 0, 0},
         up,
         up,
         45},
        {"ring_stretched",
         lamp(shape_of(ring, placed({above, tilted, Transform::scale(1, 0.5, 1)})), true),
         {0.5f, 0, 0},
         up,
         up,
         50},
        {"uniform_sky_on_surface",
         [](LightScene& s) { s.add_light(InfiniteLight{}); },
         {},
         {0.6f, 0, 0.8f}},
        {"uniform_sky_everywhere", [](LightScene& s) { s.add_light(InfiniteLight{}); }, {}, {}},
        {"square_map", sky(square_map(), {}), {}, up},
        {"square_map_tilted", sky(square_map(), tilted), {}, up},
        {"square_map_sheared", sky(square_map(), tilted * Transform::scale(1, 2, 0.7)), {}, up},
        {"lat_long_map", sky(lat_long_map(), {}), {}, up},
        {"lat_long_map_mirrored", sky(lat_long_map(), Transform::scale(-1, 1, 1)), {}, up},
        {"portal", portal(nullptr, {}), {0.3f, 0, 0}, up, up, 50},
        {"portal_close", portal(nullptr, {}), {0.3f, 0.4f, 1.9f}, {}, up, 88},
        {"portal_aside", portal(nullptr, {}), {4, 1, 1.5f}, {-1, 0, 0}, {-4, -1, 0.5f}, 14},
        {"portal_and_square", portal(&square_map(), tilted), {0.3f, 0, 0}, up, up, 50},
        {"portal_and_lat_long", portal(&lat_long_map(), {}), {0.3f, 0, 0}, up, up, 50},
        {"sun", sun(0.53f), {}, up, slanted, 0.3f},
        {"wide_sun", sun(120), {}, up, slanted, 70},
        {"sun_in_the_sky",
         [=](LightScene& s) {
             sky(square_map(), tilted)(s);
             s.add_light(InfiniteLight{});
             sun(30)(s);
         },
         {},
         up},
        {"everything",
         [=](LightScene& s) {
             sun(20)(s);
             sky(square_map(), tilted)(s);
             sky(lat_long_map(), {})(s);
             portal(&lat_long_map(), tilted)(s);
             s.add_light(InfiniteLight{});
             s.add_light(DistantLight{});
             s.add_light(PointLight{});
             s.add(mesh_of(cube(), placed({Transform::translate({3, 0, 1})})), Rgb(5));
             s.add(shape_of(whole_sphere(1), placed({Transform::translate({0, -4, 2})})), Rgb(5));
         },
         {},
         up},
    };
}

/// Cells of equal solid angle over a cone of directions.
class Cells {
  public:
    static constexpr int kRings = 24, kSectors = 24;
    Cells(Vec3 axis, float degrees)
        : frame_(Frame::from_z(normalize(axis))),
          rim_(degrees >= 180 ? 2 : 1 - std::cos(degrees * kPi / 180)) {}
    float solid_angle() const { return 2 * kPi * rim_ / (kRings * kSectors); }
    size_t count() const { return kRings * kSectors; }
    Vec3 direction(float ring, float sector) const {
        const Vec3 w = square_to_cone({ring / kRings, sector / kSectors}, rim_);
        return normalize(frame_.to_world(w));
    }
    /// The cell of a direction; -1 outside the cone.
    int cell(Vec3 w) const {
        const Vec3 l = frame_.to_local(w);
        const float s2 = l.x * l.x + l.y * l.y;
        const float h = l.z > 0 ? s2 / (1 + l.z) : 1 - l.z;
        if (h >= rim_ && rim_ < 2) return -1;
        float phi = std::atan2(l.y, l.x);
        if (phi < 0) phi += 2 * kPi;
        const int ring = std::min(int(h / rim_ * kRings), kRings - 1);
        return ring * kSectors + std::min(int(phi / (2 * kPi) * kSectors), kSectors - 1);
    }

  private:
    Frame frame_;
    float rim_;
};

/// Whether a light is seen under an angle at which the density of area sampling, the inverse of the
/// cosine, can be integrated numerically.
bool is_clear(Vec3 normal, Vec3 wi) {
    return abs_dot(normal, wi) > 0.1f;
}

class LightSampling : public testing::TestWithParam<Case> {};

TEST_P(LightSampling, DirectionsFollowTheDensity) {
    const Case& c = GetParam();
    LightScene s;
    c.make(s);
    s.build();
    const Cells cells(c.axis, c.cone_degrees);
    // Cells are first those of area lights, then those of infinite ones, then one for all that is
    // left over.
    std::vector<double> observed(2 * cells.count() + 1), expected(observed.size());
    constexpr int kSamples = 200000, kSteps = 64;
    Rng rng(17);
    const int first_infinite = s.lights->count() - int(s.description.lights.size());
    int deltas = 0;
    for (int i = 0; i < kSamples; ++i) {
        const float u = rng.next_float();
        const auto sample = s.lights->sample(c.p, c.n, c.time, u, rng.next_2d());
        if (sample && sample->is_delta) {
            ++deltas;
            continue;
        }
        const int cell = sample ? cells.cell(sample->wi) : -1;
        if (!sample) {
            ++observed.back();
            continue;
        }
        if (sample->distance < kInfinity && !is_clear(sample->normal, sample->wi)) {
            ++observed.back();
            continue;
        }
        ASSERT_GE(cell, 0) << "outside the cone that should hold the light";
        ++observed[size_t(cell) + (sample->light >= first_infinite ? cells.count() : 0)];
    }
    double total = 0;
    for (int ring = 0; ring < Cells::kRings; ++ring)
        for (int sector = 0; sector < Cells::kSectors; ++sector) {
            double area = 0, sky = 0;
            for (int a = 0; a < kSteps; ++a)
                for (int b = 0; b < kSteps; ++b) {
                    // Points are jittered: a regular grid would line up with the edges of lights
                    // and texels.
                    const Vec2 j = rng.next_2d();
                    const Vec3 w = cells.direction(float(ring) + (float(a) + j.x) / kSteps,
                                                   float(sector) + (float(b) + j.y) / kSteps);
                    SurfaceHit hit;
                    if (s.geometry->intersect({c.p, w, c.time}, hit) && is_clear(hit.ng, w))
                        area += s.lights->pdf(c.p, c.n, w, hit);
                    sky += s.lights->environment_pdf(c.p, c.n, w);
                }
            const size_t cell = size_t(ring * Cells::kSectors + sector);
            const double scale = double(kSamples) * cells.solid_angle() / (kSteps * kSteps);
            expected[cell] = area * scale;
            expected[cell + cells.count()] = sky * scale;
            total += expected[cell] + expected[cell + cells.count()];
        }
    expected.back() = std::max(0.0, kSamples - deltas - total);
    // The remainder carries the error of the quadrature and of the deltas' count.
    const double slack = 0.002 * kSamples;
    EXPECT_NEAR(observed.back(), kSamples - deltas - total,
                slack + 5 * std::sqrt(observed.back() + double(deltas)));
    observed.pop_back();
    expected.pop_back();
    const ChiSquare test = chi_square_test(observed, expected);
    EXPECT_GT(test.p, sidak(0.01, all_cases().size()))
        << "chi-square " << test.value << " of " << test.degrees;
}

TEST_P(LightSampling, DensityOfAHitIsThatOfTheSample) {
    const Case& c = GetParam();
    LightScene s;
    c.make(s);
    s.build();
    Rng rng(23);
    int compared = 0;
    for (int i = 0; i < 20000; ++i) {
        const Vec2 a = rng.next_2d(), b = rng.next_2d();
        const Vec3 p = c.p + Vec3{a.x - 0.5f, a.y - 0.5f, b.x - 0.5f} * 0.2f;
        const Vec3 n = i % 2 ? square_to_sphere(rng.next_2d()) : Vec3{};
        const float time = rng.next_float(), u = rng.next_float();
        const auto sample = s.lights->sample(p, n, time, u, rng.next_2d());
        if (!sample || sample->is_delta) continue;
        if (sample->distance == kInfinity) {
            ASSERT_NEAR(s.lights->environment_pdf(p, n, sample->wi) / sample->pdf, 1, 1e-4);
            ASSERT_EQ(s.lights->environment(p, sample->wi), sample->radiance);
            continue;
        }
        SurfaceHit hit;
        if (!s.geometry->intersect({p, sample->wi, time}, hit)) continue;  // rounding at an edge
        if (distance(hit.position, sample->position) > 1e-3f * sample->distance)
            continue;  // hidden
        const float facing = abs_dot(hit.ng, sample->wi);
        if (facing < 0.02f)
            continue;  // the density of area samples is the inverse of a rounded cosine
        ++compared;
        ASSERT_NEAR(s.lights->pdf(p, n, sample->wi, hit) / sample->pdf, 1, 5e-3) << compared;
        ASSERT_GT(dot(hit.ng, sample->normal), 0.999f);
        ASSERT_EQ(s.lights->emitted(hit, -sample->wi), sample->radiance);
    }
    const bool has_area_lights = s.lights->count() > int(s.description.lights.size());
    EXPECT_GE(compared, has_area_lights ? 500 : 0);
}

TEST_P(LightSampling, SelectionProbabilitiesSumToOneAtMost) {
    const Case& c = GetParam();
    LightScene s;
    c.make(s);
    s.build();
    Rng rng(29);
    for (int i = 0; i < 1000; ++i) {
        const Vec3 p = square_to_sphere(rng.next_2d()) * (10 * rng.next_float());
        const Vec3 n = i % 3 ? square_to_sphere(rng.next_2d()) : Vec3{};
        double sum = 0;
        for (int light = 0; light < s.lights->count(); ++light)
            sum += double(s.lights->selection_probability(p, n, light));
        // Choosing a group of lights chooses none of them where all of them look away from p.
        ASSERT_LE(sum, 1 + 1e-5);
        if (c.looks_everywhere()) {
            ASSERT_NEAR(sum, 1, 1e-5);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Lights, LightSampling, testing::ValuesIn(all_cases()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace covtrace
