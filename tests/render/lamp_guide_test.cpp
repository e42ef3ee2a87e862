// Lamps behind walls: the guide leaves them to the rooms that they light, and light is counted
// right.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/parallel.h"
#include "core/rng.h"
#include "integrator/path.h"
#include "pbrt/read_scene.h"
#include "tests/statistical/chi_square.h"
#include "tests/statistical/path_moments.h"

namespace covtrace {
namespace {

std::string quad(const std::string& corners) {
    return "Shape \"trianglemesh\" \"point3 P\" [ " + corners +
           " ] \"integer indices\" [ 0 1 2 0 2 3 ]\n";
}

std::string lamp(double x, double y, double light) {
    const auto at = [](double v) { return std::to_string(v); };
    return "AttributeBegin\nAreaLightSource \"diffuse\" \"rgb L\" [ " + at(light) + " " +
           at(light) + " " + at(light) + " ]\nTranslate " + at(x) + " " + at(y) +
           " 2\nShape \"sphere\" \"float radius\" 0.1\nAttributeEnd\n";
}

// Two closed grey rooms of 4 by 4 by 2.4, the camera in that at x < 0.
std::string rooms() {
    return quad("-4 -2 0 4 -2 0 4 2 0 -4 2 0") + quad("-4 -2 2.4 4 -2 2.4 4 2 2.4 -4 2 2.4") +
           quad("-4 2 0 4 2 0 4 2 2.4 -4 2 2.4") + quad("-4 -2 0 4 -2 0 4 -2 2.4 -4 -2 2.4") +
           quad("-4 -2 0 -4 2 0 -4 2 2.4 -4 -2 2.4") + quad("4 -2 0 4 2 0 4 2 2.4 4 -2 2.4") +
           quad("0 -2 0 0 2 0 0 2 2.4 0 -2 2.4");
}

/// A lamp in the camera's room, and `count` lamps, ten times as strong, in the other.
std::string lamps_behind(int count) {
    std::string text = lamp(-2, 0.5, 10);
    for (int i = 0; i < count; ++i)
        text += lamp(0.5 + 3.0 * (i % 40) / 40, -1.5 + 0.3 * (i / 40 % 10), 100);
    return text;
}

SceneDescription scene_of(const std::string& lights) {
    return read_pbrt_string(R"(
Integrator "path" "integer maxdepth" 5
Film "rgb" "integer xresolution" 128 "integer yresolution" 96
PixelFilter "box"
LookAt -3.8 0 1.2  0 0 1  0 0 1
Camera "perspective" "float fov" 60
WorldBegin
Material "diffuse" "rgb reflectance" [ 0.6 0.5 0.4 ]
)" + lights + rooms(),
                            "test", ".");
}

/// A place of the film, in pixels, that shows the floor.
const Vec2 kSeen{64, 90};

// The bound is 4.5 standard errors: false alarm 7e-6 for each.
TEST(LampGuide, FindsTheLampOfTheRoomAndLeavesTheMean) {
    for (const int behind : {12, 400}) {
        RenderScene scene(scene_of(lamps_behind(behind)));
        ASSERT_EQ(scene.lamp_guide.outcome().state, GuideState::guides) << behind;
        EXPECT_LT(scene.lamp_guide.outcome().second_moment, 0.4) << behind;
        EXPECT_GT(scene.lamp_guide.outcome().bytes, 0u);
        constexpr int kPaths = 60000;
        const test::Moments guided = test::trace_place(scene, kSeen, kPaths);
        scene.lamp_guide = LampGuide();
        const test::Moments alone = test::trace_place(scene, kSeen, kPaths);
        EXPECT_LT(guided.variance(), 0.3 * alone.variance()) << behind;
        EXPECT_NEAR(guided.mean(), alone.mean(), 4.5 * std::hypot(guided.error(), alone.error()))
            << behind;
    }
}

// Chi-square over the lamps: alpha 1e-4.
TEST(LampGuide, LampsAreDrawnWithTheirProbability) {
    const RenderScene scene(scene_of(lamps_behind(40)));
    const Vec3 p{-1, 0.3f, 0.01f}, n{0, 0, 1};
    const LightTree::Factors factors = scene.lamp_guide.at(p, n);
    ASSERT_FALSE(factors.empty());
    const auto count = static_cast<size_t>(scene.lights.count());
    constexpr int kSamples = 100000;
    std::vector<double> observed(count), expected(count);
    double sum = 0;
    for (size_t i = 0; i < count; ++i) {
        const double share = scene.lights.selection_probability(p, n, int(i), factors);
        sum += share;
        expected[i] = share * kSamples;
    }
    EXPECT_NEAR(sum, 1, 1e-4);
    // The room's own lamp, the first, is nearly alone; by importance it is one of many
    EXPECT_GT(expected[0], 0.5 * kSamples);
    EXPECT_LT(scene.lights.selection_probability(p, n, 0), 0.5);
    Rng rng(5);
    int met = 0;
    for (int i = 0; i < kSamples; ++i) {
        const float u_select = rng.next_float();
        const auto light =
            scene.lights.finish_draw(p, n, 0, u_select, {rng.next_2d(), {}, 0}, nullptr, factors);
        ASSERT_TRUE(light);
        ++observed[size_t(light->light)];
        if (i >= 1000) continue;
        // Paths that meet the point by chance weigh it by the same density
        Ray ray;
        ray.origin = p;
        ray.direction = light->wi;
        SurfaceHit hit;
        if (!scene.geometry.intersect(ray, hit) || light->light != 0) continue;
        EXPECT_NEAR(scene.lights.pdf(p, n, light->wi, hit, factors) / light->pdf, 1, 1e-3);
        ++met;
    }
    EXPECT_GT(met, 400);
    EXPECT_GT(chi_square_test(observed, expected).p, 1e-4);
}

TEST(LampGuide, GivesUpWhereAllLampsAreSeen) {
    const RenderScene alone(scene_of(lamp(-2, 0.5, 10)));
    EXPECT_EQ(alone.lamp_guide.outcome().state, GuideState::unused);
    EXPECT_TRUE(alone.lamp_guide.at({-1, 0, 0}, {0, 0, 1}).empty());
    const RenderScene seen(scene_of(lamp(-2, 1, 10) + lamp(-2, -1, 10) + lamp(-1, 0, 10)));
    EXPECT_EQ(seen.lamp_guide.outcome().state, GuideState::gave_up);
    EXPECT_TRUE(seen.lamp_guide.at({-1, 0, 0}, {0, 0, 1}).empty());
}

TEST(LampGuide, LeavesAllPathsAloneWhereThereAreToBeNoGuides) {
    const RenderScene scene(scene_of(lamps_behind(12)), {}, kNoTextureLimit, Guides::none);
    for (const auto& [name, outcome] : scene.guide_outcomes()) {
        EXPECT_EQ(outcome.state, GuideState::unused) << name;
        EXPECT_EQ(outcome.seconds, 0) << name;
    }
    EXPECT_TRUE(scene.lamp_guide.is_empty());
}

TEST(LampGuide, StopsLearningSoonWhereNobodyWantsIt) {
    const auto asked = [](int64_t enough, GuideState expected) {
        std::atomic<int64_t> times{0};
        const RenderScene scene(scene_of(lamps_behind(12)), {}, kNoTextureLimit, Guides::automatic,
                                [&] { return ++times > enough; });
        EXPECT_EQ(scene.lamp_guide.outcome().state, expected);
        EXPECT_FALSE(scene.is_interrupted);
        return times.load();
    };
    const int64_t all = asked(std::numeric_limits<int64_t>::max(), GuideState::guides);
    // At each path, by every thread once after the answer
    for (const int64_t enough : {int64_t(0), int64_t(1000), all / 8})
        EXPECT_LE(asked(enough, GuideState::unused), enough + 64);
    EXPECT_GT(all, 10000);
}

TEST(LampGuide, IsTheSameForAnyNumberOfThreads) {
    const auto light = [](int threads) {
        const ThreadLimit limit(threads);
        return test::trace_place(RenderScene(scene_of(lamps_behind(12))), kSeen, 500);
    };
    const test::Moments one = light(1), four = light(4);
    EXPECT_EQ(one.mean(), four.mean());
    EXPECT_EQ(one.variance(), four.variance());
}

}  // namespace
}  // namespace covtrace
