// Light that comes from another room: the guide finds it, and it is counted right.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/parallel.h"
#include "core/rng.h"
#include "core/warp.h"
#include "integrator/path.h"
#include "pbrt/read_scene.h"
#include "tests/statistical/chi_square.h"
#include "tests/statistical/path_moments.h"

namespace covtrace {
namespace {

// Two closed grey rooms, of 4 by 4 by 2.4 each, with an opening of 1.2 by 1.6 in the wall between
// them at x = 2. The camera is in one, a lamp, which faces away from the opening, in the other.
const std::string kRooms = R"(
Integrator "path" "integer maxdepth" 12
Film "rgb" "integer xresolution" 96 "integer yresolution" 72
PixelFilter "box"
LookAt 1.8 -1.8 1.6  -2 2 0.8  0 0 1
Camera "perspective" "float fov" 60
WorldBegin
Material "diffuse" "rgb reflectance" [ 0.6 0.5 0.4 ]
Shape "trianglemesh" "point3 P" [ -2 -2 0 6 -2 0 6 2 0 -2 2 0 ] "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ -2 -2 2.4 6 -2 2.4 6 2 2.4 -2 2 2.4 ]
  "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ -2 2 0 6 2 0 6 2 2.4 -2 2 2.4 ] "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ -2 -2 0 6 -2 0 6 -2 2.4 -2 -2 2.4 ]
  "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ -2 -2 0 -2 2 0 -2 2 2.4 -2 -2 2.4 ]
  "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ 6 -2 0 6 2 0 6 2 2.4 6 -2 2.4 ] "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ 2 -2 0 2 -0.6 0 2 -0.6 2.4 2 -2 2.4 ]
  "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ 2 0.6 0 2 2 0 2 2 2.4 2 0.6 2.4 ] "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ 2 -0.6 0 2 0.6 0 2 0.6 0.4 2 -0.6 0.4 ]
  "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ 2 -0.6 2 2 0.6 2 2 0.6 2.4 2 -0.6 2.4 ]
  "integer indices" [ 0 1 2 0 2 3 ]
AreaLightSource "diffuse" "rgb L" [ 50 50 50 ]
Shape "trianglemesh" "point3 P" [ 2.1 -1 1 2.1 -0.5 1 2.1 -0.5 1.5 2.1 -1 1.5 ]
  "integer indices" [ 0 1 2 0 2 3 ]
)";

RenderScene rooms() {
    return RenderScene(read_pbrt_string(kRooms, "test", "."));
}

const PlaceTree::Place kFloor{{-0.5f, 0.5f, 0}, {0, 0, 1}};
const Vec3 kOpening{2, 0, 1.3f}, kWall{2, -1.5f, 1.3f};

/// A place of the film, in pixels, that shows the floor.
const Vec2 kSeen{48, 60};

// The bound is 4.5 standard errors: false alarm 7e-6.
TEST(PathGuide, FindsTheLightAndLeavesTheMean) {
    RenderScene scene = rooms();
    ASSERT_FALSE(scene.path_guide.is_empty());
    EXPECT_GT(scene.path_guide.outcome().bytes, 0u);
    constexpr int kPaths = 60000;
    const test::Moments guided = test::trace_place(scene, kSeen, kPaths);
    scene.path_guide = PathGuide();
    const test::Moments alone = test::trace_place(scene, kSeen, kPaths);
    EXPECT_LT(guided.variance(), 0.6 * alone.variance());
    EXPECT_NEAR(guided.mean(), alone.mean(), 4.5 * std::hypot(guided.error(), alone.error()));
}

// Chi-square over cosine and azimuth, expectations by 32x32 points of each part: alpha 1e-4. Cones
// to spots reach below the horizon.
TEST(PathGuide, SamplesItsDensity) {
    const RenderScene scene = rooms();
    const PathGuideMixture led = scene.path_guide.at(kFloor);
    ASSERT_GT(led.share(), 0);
    const auto towards = [](Vec3 p) { return normalize(p - kFloor.position); };
    EXPECT_GT(led.pdf(towards(kOpening)), 2 * led.pdf(towards(kWall)));
    EXPECT_EQ(led.pdf({0, 0, -1}), 0);
    constexpr int kRings = 16, kSectors = 16, kSamples = 100000, kPoints = 32;
    std::vector<double> counts(kRings * kSectors, 0.0), expected(kRings * kSectors, 0.0);
    const Frame frame = Frame::from_z(kFloor.normal);
    Rng rng(17);
    for (int i = 0; i < kSamples; ++i) {
        const float choice = rng.next_float();
        const Vec3 local = frame.to_local(led.sample(choice, rng.next_2d()));
        const double phi = std::atan2(double(local.y), double(local.x)) / (2 * M_PI) + 0.5;
        counts[size_t(std::min(int((double(local.z) + 1) / 2 * kRings), kRings - 1) * kSectors +
                      std::min(int(phi * kSectors), kSectors - 1))] += 1;
    }
    double whole = 0;
    for (int ring = 0; ring < kRings * kPoints; ++ring)
        for (int sector = 0; sector < kSectors * kPoints; ++sector) {
            const double c = 2 * (ring + 0.5) / (kRings * kPoints) - 1, s = std::sqrt(1 - c * c);
            const double phi = 2 * M_PI * ((sector + 0.5) / (kSectors * kPoints) - 0.5);
            const Vec3 w =
                frame.to_world({float(s * std::cos(phi)), float(s * std::sin(phi)), float(c)});
            const double share =
                double(led.pdf(w)) * 4 * M_PI / (kRings * kSectors * kPoints * kPoints);
            expected[size_t(ring / kPoints * kSectors + sector / kPoints)] += share * kSamples;
            whole += share;
        }
    EXPECT_NEAR(whole, 1, 3e-3);  // the sum's own error, at the borders of bins
    EXPECT_GT(chi_square_test(counts, expected).p, 1e-4);
}

// The same guide for any number of threads.
TEST(PathGuide, DoesNotDependOnThreads) {
    std::vector<float> densities[2];
    for (int threads : {1, 3}) {
        const ThreadLimit limit(threads);
        const RenderScene scene = rooms();
        const PathGuideMixture led = scene.path_guide.at(kFloor);
        ASSERT_GT(led.share(), 0);
        const Frame frame = Frame::from_z(kFloor.normal);
        Rng rng(5);
        std::vector<float>& found = densities[threads == 1 ? 0 : 1];
        found.push_back(led.share());
        for (int i = 0; i < 256; ++i)
            found.push_back(led.pdf(frame.to_world(square_to_cosine_hemisphere(rng.next_2d()))));
    }
    EXPECT_EQ(densities[0], densities[1]);
}

// A ray through a thousand media, one inside the other, is a thousand rays: what guides learn from
// would take longer than the render.
TEST(PathGuide, IsNotLearntFromPathsOfThousandsOfRays) {
    const auto outcomes = [](int media) {
        std::string scene =
            "Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 64\n"
            "LookAt 0 0 4 0 0 0 0 1 0\nCamera \"perspective\" \"float fov\" 30\nWorldBegin\n"
            "LightSource \"infinite\"\nShape \"sphere\"\nMaterial \"interface\"\n";
        for (int i = 0; i < media; ++i) {
            const std::string name = "m" + std::to_string(i);
            scene += "MakeNamedMedium \"" + name +
                     "\" \"string type\" \"homogeneous\" \"rgb sigma_s\" [ 0.01 0.01 0.01 ]\n"
                     "MediumInterface \"" +
                     name + "\" \"" + (i + 1 < media ? "m" + std::to_string(i + 1) : "") +
                     "\"\nShape \"sphere\" \"float radius\" " + std::to_string(1.1 + 1e-3 * i) +
                     "\n";
        }
        return RenderScene(read_pbrt_string(scene, "test", ".")).guide_outcomes();
    };
    EXPECT_EQ(outcomes(1)["paths"].state, GuideState::gave_up);
    for (const auto& [name, outcome] : outcomes(1000))
        EXPECT_EQ(outcome.state, GuideState::unused) << name;
}

// In an even light there is nothing to be learnt. Led by a guide all the same, paths bring what the
// shell of the furnace sends: 4.5 standard errors, false alarm 7e-6.
TEST(PathGuide, LeavesTheFurnaceAlone) {
    RenderScene scene(
        read_pbrt(std::string(COVTRACE_SCENES_FOLDER) + "/tests/furnace-closed.pbrt"));
    EXPECT_TRUE(scene.path_guide.is_empty());
    scene.path_guide.learn(trace_lesson(scene, scene.guide, scene.sky_guide, scene.lamp_guide,
                                        scene.path_guide, 0, 4096));
    ASSERT_FALSE(scene.path_guide.is_empty());
    constexpr int kPaths = 40000;
    double sum = 0, squares = 0;
    for (int i = 0; i < kPaths; ++i) {
        const Sampler sampler(3, i & 0xffff, i >> 16, 0);
        const Ray ray = scene.camera.generate_ray({float(i % 64), 5}, {}, 0);
        const double l = trace_path(scene, ray, sampler, 20, nullptr).radiance.g;
        sum += l / kPaths;
        squares += l * l / kPaths;
    }
    EXPECT_NEAR(sum, 1, 4.5 * std::sqrt((squares - sum * sum) / kPaths) + 1e-5);
}

}  // namespace
}  // namespace covtrace
