// Light of the sky that comes through a window: found by the guide, and counted right.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/parallel.h"
#include "integrator/path.h"
#include "pbrt/read_scene.h"
#include "tests/statistical/chi_square.h"
#include "tests/statistical/path_moments.h"
#include "tests/unit/pbrt_test_support.h"

namespace covtrace {
namespace {

// A closed grey room of 4 by 4 by 2.4, with a window of 0.6 by 0.6 in the wall at x = 2.
const std::string kRoom = R"(
Shape "trianglemesh" "point3 P" [ -2 -2 0 2 -2 0 2 2 0 -2 2 0 ] "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ -2 -2 2.4 2 -2 2.4 2 2 2.4 -2 2 2.4 ]
  "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ -2 2 0 2 2 0 2 2 2.4 -2 2 2.4 ] "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ -2 -2 0 2 -2 0 2 -2 2.4 -2 -2 2.4 ]
  "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ -2 -2 0 -2 2 0 -2 2 2.4 -2 -2 2.4 ]
  "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ 2 -2 0 2 -0.3 0 2 -0.3 2.4 2 -2 2.4 ]
  "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ 2 0.3 0 2 2 0 2 2 2.4 2 0.3 2.4 ] "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ 2 -0.3 0 2 0.3 0 2 0.3 1 2 -0.3 1 ]
  "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ 2 -0.3 1.6 2 0.3 1.6 2 0.3 2.4 2 -0.3 2.4 ]
  "integer indices" [ 0 1 2 0 2 3 ]
)";

SceneDescription scene_of(const std::string& shapes, const std::string& light) {
    return read_pbrt_string(R"(
Integrator "path" "integer maxdepth" 6
Film "rgb" "integer xresolution" 128 "integer yresolution" 96
PixelFilter "box"
LookAt -1.8 0 1.2  2 0 1  0 0 1
Camera "perspective" "float fov" 60
WorldBegin
)" + light + R"(
Material "diffuse" "rgb reflectance" [ 0.6 0.5 0.4 ]
)" + shapes,
                            "test", ".");
}

const std::string kEvenSky = R"(LightSource "infinite" "rgb L" [ 5 6 8 ])";

/// A place of the film, in pixels, that shows the floor, and no window.
const Vec2 kSeen{64, 90};

// The bound is 4.5 standard errors: false alarm 7e-6.
TEST(SkyGuide, FindsTheWindowAndLeavesTheMean) {
    RenderScene scene(scene_of(kRoom, kEvenSky));
    ASSERT_FALSE(scene.sky_guide.is_empty());
    constexpr int kPaths = 60000;
    const test::Moments guided = test::trace_place(scene, kSeen, kPaths);
    scene.sky_guide = SkyGuide();
    const test::Moments alone = test::trace_place(scene, kSeen, kPaths);
    EXPECT_LT(guided.variance(), 0.35 * alone.variance());
    EXPECT_NEAR(guided.mean(), alone.mean(), 4.5 * std::hypot(guided.error(), alone.error()));
}

/// A sky like a chess board of 64 by 64 fields, half of them black.
std::string chess_board() {
    constexpr int kSide = 256, kField = 4;
    std::vector<float> texels;
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x)
            texels.insert(texels.end(), 3, (x / kField + y / kField) % 2 ? 1.0f : 0.0f);
    return "PF\n" + std::to_string(kSide) + " " + std::to_string(kSide) + "\n-1\n" +
           std::string(reinterpret_cast<const char*>(texels.data()), texels.size() * sizeof(float));
}

/// Directions that the guide takes to black parts of the sky bring no light of a lamp on the way,
/// which lights' own samples do. The bound is 4.5 standard errors: false alarm 7e-6.
TEST(SkyGuide, LeavesLampsBehindPanesAsTheyAre) {
    const test::TemporaryFolder folder;
    const std::string sky = folder.write("sky.pfm", chess_board()).string();
    RenderScene scene(scene_of(kRoom + R"(
Material "thindielectric" "float eta" 1.5
Shape "trianglemesh" "point3 P" [ 2 -0.3 1 2 0.3 1 2 0.3 1.6 2 -0.3 1.6 ]
  "integer indices" [ 0 1 2 0 2 3 ]
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 6 6 6 ] "bool letslightpass" true
Translate 8 0 5
Shape "sphere" "float radius" 2.5
AttributeEnd
)",
                               "LightSource \"infinite\" \"string filename\" \"" + sky + "\""));
    ASSERT_FALSE(scene.sky_guide.is_empty());
    ASSERT_TRUE(scene.samples_through_panes);
    constexpr int kPaths = 60000;
    const test::Moments guided = test::trace_place(scene, kSeen, kPaths);
    scene.sky_guide = SkyGuide();
    const test::Moments alone = test::trace_place(scene, kSeen, kPaths);
    EXPECT_NEAR(guided.mean(), alone.mean(), 4.5 * std::hypot(guided.error(), alone.error()));
}

// Chi-square over the blocks and one more: alpha 1e-4.
TEST(SkyGuide, SamplesItsDensity) {
    const RenderScene scene(scene_of(kRoom, kEvenSky));
    const SkyCell* cell = scene.sky_guide.at({0, 0.5f, 0}, {0, 0, 1});
    ASSERT_NE(cell, nullptr);
    // The window's middle is found far more often than the wall beside it
    const Vec3 p{0, 0.5f, 0};
    EXPECT_GT(cell->pdf(normalize(Vec3{2, 0, 1.3f} - p)),
              10 * cell->pdf(normalize(Vec3{2, -1.9f, 1.3f} - p)));
    constexpr int kSamples = 200000;
    std::vector<double> observed(SkyCell::kBlocks), expected(SkyCell::kBlocks);
    for (int i = 0; i < kSamples; ++i) {
        Sampler s(5, i, 0, 0);
        ++observed[SkyCell::block(cell->sample(s.next_2d()))];
    }
    double sum = 0;
    for (size_t y = 0; y < SkyCell::kSide; ++y)
        for (size_t x = 0; x < SkyCell::kSide; ++x) {
            const Vec3 w = equal_area_square_to_sphere(
                {(float(x) + 0.5f) / SkyCell::kSide, (float(y) + 0.5f) / SkyCell::kSide});
            const double share = double(cell->pdf(w)) * 4 * double(kPi) / double(SkyCell::kBlocks);
            expected[y * SkyCell::kSide + x] = share * kSamples;
            sum += share;
        }
    EXPECT_NEAR(sum, 1, 1e-5);
    EXPECT_GT(chi_square_test(observed, expected).p, 1e-4);
}

TEST(SkyGuide, GivesUpUnderAnOpenSky) {
    const std::string floor = R"(
Shape "trianglemesh" "point3 P" [ -9 -9 0 9 -9 0 9 9 0 -9 9 0 ] "integer indices" [ 0 1 2 0 2 3 ]
Translate 0 0 0.5
Shape "sphere" "float radius" 0.5
)";
    EXPECT_TRUE(RenderScene(scene_of(floor, kEvenSky)).sky_guide.is_empty());
    EXPECT_TRUE(RenderScene(scene_of(kRoom, R"(LightSource "point" "point3 from" [ 0 0 2 ])"))
                    .sky_guide.is_empty());
}

TEST(SkyGuide, IsTheSameForAnyNumberOfThreads) {
    const auto light = [](int threads) {
        const ThreadLimit limit(threads);
        return test::trace_place(RenderScene(scene_of(kRoom, kEvenSky)), kSeen, 500);
    };
    const test::Moments one = light(1), four = light(4);
    EXPECT_EQ(one.mean(), four.mean());
    EXPECT_EQ(one.variance(), four.variance());
}

}  // namespace
}  // namespace covtrace
