// The furnaces of scenes/tests: every pixel's value is known and stands at the head of its file.
#include <gtest/gtest.h>

#include "integrator/path.h"
#include "tests/render/fixtures.h"

namespace covtrace {
namespace {

using namespace test;

struct Furnace {
    const char* name;
    float middle;  ///< mean of the image's middle, a quarter of each side around the centre
    float corner;  ///< mean of the four corners, an eighth of each side
};

void PrintTo(const Furnace& f, std::ostream* out) {
    *out << f.name;
}

class FurnaceFile : public testing::TestWithParam<Furnace> {};

/// Asserts the mean over a block within 5 standard errors (false alarm 6e-7) and 2e-3.
void expect_block(const Image& image, int x0, int y0, int size, float expected) {
    double mean = 0, variance = 0;
    for (int y = y0; y < y0 + size; ++y)
        for (int x = x0; x < x0 + size; ++x) {
            const size_t i = size_t(y) * size_t(image.width()) + size_t(x);
            mean += image.rgb(i).g;
            variance += image.rgb(i, "variance.").g;
        }
    const double n = size * size;
    EXPECT_NEAR(mean / n, expected, 5 * std::sqrt(variance) / n + 2e-3)
        << "block at " << x0 << ", " << y0;
}

TEST_P(FurnaceFile, ShowsItsValue) {
    const Furnace& f = GetParam();
    for (Method method : {Method::uniform, Method::covariance, Method::hybrid}) {
        RenderScene scene(read_pbrt(std::filesystem::path(COVTRACE_SCENES_FOLDER) / "tests" /
                                    (std::string(f.name) + ".pbrt")));
        RenderOptions options = uniform(64, 7);
        options.method = method;
        Monitor monitor;
        const Image image = render(scene, options, monitor).image;
        EXPECT_EQ(summarize_image(image).nonfinite, 0);
        const int w = image.width(), h = image.height();
        expect_block(image, 3 * w / 8, 3 * h / 8, w / 4, f.middle);
        for (int x : {0, 7 * w / 8})
            for (int y : {0, 7 * h / 8}) expect_block(image, x, y, w / 8, f.corner);
    }
}

INSTANTIATE_TEST_SUITE_P(Scenes, FurnaceFile,
                         testing::Values(Furnace{"furnace-diffuse", 0.5f, 1},
                                         Furnace{"furnace-glass", 1, 1},
                                         Furnace{"furnace-mirror", 1, 1},
                                         Furnace{"furnace-transmission", 7 / 12.0f, 1},
                                         Furnace{"furnace-closed", 1, 1}));

TEST(FurnaceFile, LensAndMotionKeepTheWeights) {
    RenderScene scene(read_pbrt(std::filesystem::path(COVTRACE_SCENES_FOLDER) /
                                "tests/furnace-lens-motion.pbrt"));
    Monitor monitor;
    const Image image = render(scene, uniform(64), monitor).image;
    expect_block(image, 26, 26, 12, 0.5f);
    for (int y = 0; y < 64; y += 8) {
        expect_block(image, 0, y, 8, 1);
        expect_block(image, 56, y, 8, 1);
    }
}

// Where nothing is absorbed roulette has no reason to end a path before the bounce the scene
// allows.
TEST(Furnace, AMillionBouncesBetweenWhiteWallsAreNotTaken) {
    const RenderScene scene(
        read_pbrt_string("Integrator \"path\" \"integer maxdepth\" 1000000\n"
                         "WorldBegin\nLightSource \"point\" \"rgb I\" [ 1 1 1 ]\n"
                         "Material \"diffuse\" \"rgb reflectance\" [ 1 1 1 ]\n"
                         "ReverseOrientation\nShape \"sphere\" \"float radius\" 2\n",
                         "test", "."));
    double bounces = 0;
    constexpr int kPaths = 64;
    for (int i = 0; i < kPaths; ++i) {
        Sampler sampler(1, i, 0, 0);
        const PathResult path =
            trace_path(scene, {{0, 0, 1}, {0, 0, 1}}, sampler, 1'000'000, nullptr);
        EXPECT_TRUE(std::isfinite(path.radiance.g));
        bounces += path.rays.bounce;
    }
    // Paths have 1000 bounces and a geometric number of mean 100: the mean of 64 is within 6
    // standard errors of it.
    EXPECT_NEAR(bounces / kPaths, 1100, 6 * 100 / std::sqrt(double(kPaths)));
}

}  // namespace
}  // namespace covtrace
