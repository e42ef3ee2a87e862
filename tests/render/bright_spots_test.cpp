// Light from small bright spots on surfaces: they are found, and what they send is counted right.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/rng.h"
#include "core/warp.h"
#include "integrator/guides/bright_spots.h"
#include "integrator/path.h"
#include "pbrt/read_scene.h"
#include "tests/statistical/path_moments.h"

namespace covtrace {
namespace {

// A closed room of 4 by 4 by 2.4 with white walls, and a lamp the size of a walnut just below the
// ceiling: half of its light comes from a hand's breadth of it.
const std::string kRoom = R"(
Integrator "path" "integer maxdepth" 8
Film "rgb" "integer xresolution" 96 "integer yresolution" 72
PixelFilter "box"
LookAt 1.8 -1.8 1.6  -2 2 0.6  0 0 1
Camera "perspective" "float fov" 60
WorldBegin
Material "diffuse" "rgb reflectance" [ 0.8 0.8 0.8 ]
Shape "trianglemesh" "point3 P" [ -2 -2 0 2 -2 0 2 2 0 -2 2 0 ] "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ -2 -2 2.4 2 -2 2.4 2 2 2.4 -2 2 2.4 ]
  "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ -2 2 0 2 2 0 2 2 2.4 -2 2 2.4 ] "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ -2 -2 0 2 -2 0 2 -2 2.4 -2 -2 2.4 ]
  "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ -2 -2 0 -2 2 0 -2 2 2.4 -2 -2 2.4 ]
  "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ 2 -2 0 2 2 0 2 2 2.4 2 -2 2.4 ] "integer indices" [ 0 1 2 0 2 3 ]
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 300 300 300 ]
Translate 0.4 0.6 2.37
Shape "sphere" "float radius" 0.02
AttributeEnd
)";

const Vec3 kBright{0.4f, 0.6f, 2.4f};

/// Bounces off the floor of the room, by cosines; what ends within 0.1 of the spot found 100 times
/// the light of the rest.
std::vector<SpotHit> bounces(int count, bool has_spot) {
    std::vector<SpotHit> hits;
    Rng rng(11);
    for (int i = 0; i < count; ++i) {
        const Vec2 u = rng.next_2d();
        const Vec3 from{4 * u.x - 2, 4 * u.y - 2, 0};
        const Vec3 w = square_to_cosine_hemisphere(rng.next_2d());
        const Vec3 to = from + w * (2.4f / w.z);
        SpotHit hit{from, to, 1, 0, w.z / kPi, w.z / kPi, uint32_t(i)};
        if (has_spot && distance(to, kBright) < 0.1f) hit.light = 1000;
        hit.moment = sqr(hit.light);
        hits.push_back(hit);
    }
    return hits;
}

double noise_of(const std::vector<SpotHit>& hits) {
    double sum = 0;
    for (const SpotHit& hit : hits) sum += double(hit.moment);
    return sum;
}

TEST(BrightSpots, AreFoundWhereFewBouncesBringMostNoise) {
    const auto hits = bounces(40000, true);
    const BrightSpots spots(hits, noise_of(hits), hits.size());
    ASSERT_FALSE(spots.is_empty());
    EXPECT_TRUE(spots.holds(kBright));
    EXPECT_FALSE(spots.holds(kBright + Vec3{0.4f, 0, 0}));
    const auto even = bounces(40000, false);
    EXPECT_TRUE(BrightSpots(even, noise_of(even), even.size()).is_empty());
    // Three hits are luck
    const std::vector<SpotHit> few(hits.begin(), hits.begin() + 2000);
    EXPECT_TRUE(BrightSpots(few, noise_of(few), few.size()).is_empty());
}

// 4.5 standard errors, false alarm 7e-6 for each of the two integrals.
TEST(BrightSpots, SampleTheirDensity) {
    const auto hits = bounces(40000, true);
    const BrightSpots spots(hits, noise_of(hits), hits.size());
    for (const Vec3 p : {Vec3{-1, -1.5f, 0}, Vec3{1.9f, 1.2f, 0}}) {
        const BrightSpots::View view = spots.seen_from(p, {0, 0, 1});
        ASSERT_FALSE(view.is_empty());
        Rng rng(3);
        // The density has the integral 1
        const Frame frame = Frame::from_z(normalize(kBright - p));
        constexpr float kCone = 0.02f;  // 1 less the cosine: all of the spots
        constexpr int kSamples = 100000;
        double sum = 0, squares = 0;
        for (int i = 0; i < kSamples; ++i) {
            const Vec2 u = rng.next_2d();
            const float z = 1 - u.x * kCone, r = safe_sqrt(1 - z * z), phi = 2 * kPi * u.y;
            const double v =
                2 * double(kPi) * double(kCone) *
                double(view.pdf(frame.to_world({r * std::cos(phi), r * std::sin(phi), z})));
            sum += v / kSamples;
            squares += v * v / kSamples;
        }
        EXPECT_NEAR(sum, 1, 4.5 * std::sqrt((squares - sum * sum) / kSamples) + 1e-3);
        // Samples have it: the mean of its inverse is the solid angle where it is above 0
        double solid_angle = 0, in_cone = 0, error = 0;
        int at_rim = 0;
        for (int i = 0; i < kSamples; ++i) {
            const Vec3 w = view.sample(rng.next_2d());
            EXPECT_NEAR(length(w), 1, 1e-5f);
            const float pdf = view.pdf(w);
            // Rounding puts one sample in 100,000 just outside of its cone
            at_rim += pdf > 0 ? 0 : 1;
            const double inverse = pdf > 0 ? 1 / double(pdf) : 0;
            solid_angle += inverse / kSamples;
            error += inverse * inverse / kSamples;
        }
        for (int i = 0; i < kSamples; ++i) {
            const Vec2 u = rng.next_2d();
            const float z = 1 - u.x * kCone, r = safe_sqrt(1 - z * z), phi = 2 * kPi * u.y;
            if (view.pdf(frame.to_world({r * std::cos(phi), r * std::sin(phi), z})) > 0)
                in_cone += 1.0 / kSamples;
        }
        const double whole = 2 * double(kPi) * double(kCone);
        const double spread =
            std::sqrt(std::max(0.0, error - solid_angle * solid_angle) / kSamples) +
            whole * std::sqrt(in_cone * (1 - in_cone) / kSamples);
        EXPECT_NEAR(solid_angle, whole * in_cone, 4.5 * spread + 1e-3 * solid_angle);
        EXPECT_LE(at_rim, 10);
        EXPECT_EQ(view.pdf(-normalize(kBright - p)), 0);
    }
    EXPECT_TRUE(spots.seen_from({0, 0, 0}, {0, 0, -1}).is_empty()) << "below the horizon";
    EXPECT_TRUE(spots.seen_from(kBright, {0, 0, -1}).is_empty()) << "in the spot";
}

// The bound is 4.5 standard errors: false alarm 7e-6.
TEST(BrightSpots, LeaveTheMeanAndTakeTheNoise) {
    RenderScene scene(read_pbrt_string(kRoom, "test", "."));
    ASSERT_FALSE(scene.path_guide.is_empty());
    constexpr int kPaths = 60000;
    const Vec2 on_the_floor{48, 60};
    const test::Moments guided = test::trace_place(scene, on_the_floor, kPaths);
    scene.path_guide = PathGuide();
    const test::Moments alone = test::trace_place(scene, on_the_floor, kPaths);
    EXPECT_LT(guided.variance(), 0.3 * alone.variance());
    EXPECT_NEAR(guided.mean(), alone.mean(), 4.5 * std::hypot(guided.error(), alone.error()));
}

}  // namespace
}  // namespace covtrace
