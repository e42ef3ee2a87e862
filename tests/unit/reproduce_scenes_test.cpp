// Scenes of one cause of blur, and the search for generated ones.
#include "reproduce/test_scenes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "pbrt/read_scene.h"
#include "reproduce/grid_spectrum.h"
#include "reproduce/scene_source.h"

namespace covtrace::reproduce {
namespace {

TEST(LensBoard, IsSharpInTheMiddleAndBlursToBothSides) {
    const LensBoard board{0.05};
    EXPECT_LT(board.blur(90, 181), 0.05);
    EXPECT_GT(board.blur(0, 181), 2);
    EXPECT_GT(board.blur(180, 181), 2);
    EXPECT_NEAR(LensBoard{0.1}.blur(20, 181), 2 * board.blur(20, 181), 1e-9);
    EXPECT_EQ(LensBoard{}.blur(0, 181), 0);
    const SceneDescription scene = read_pbrt_string(board.text({320, 181}), "lens");
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_FLOAT_EQ(scene.camera.lens_radius, 0.05f);
}

TEST(MovingBoard, IsReadWithoutAWarning) {
    const SceneDescription scene = read_pbrt_string(MovingBoard{{0, 0.1}}.text({64, 36}), "motion");
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_EQ(scene.film.width, 64);
}

TEST(MovingPattern, IsReadWithoutAWarningAndMovesAroundTheShutter) {
    const auto folder = std::filesystem::temp_directory_path() / "covtrace-pattern";
    SceneSource source({}, folder);
    const auto file = source.written("slice", MovingPattern::text({64, 36}),
                                     {{MovingPattern::kFile, MovingPattern::pattern()}});
    const SceneDescription scene = read_pbrt(file);
    EXPECT_TRUE(scene.warnings.empty());
    ASSERT_EQ(scene.shapes.size(), 1u);
    const AnimatedTransform& moves = scene.shapes[0].object_to_world;
    ASSERT_TRUE(moves.is_animated());
    // A tile is 36/(4 tan 15°) pixels here, and has kBandwidth periods in a deviation.
    EXPECT_NEAR(MovingPattern::bandwidth(36), 5 * 4 * std::tan(0.2617994) / 36, 1e-6);
    std::filesystem::remove_all(folder);
}

TEST(MovingPattern, HasAGaussianSpectrum) {
    const std::string file = MovingPattern::pattern();
    constexpr int kSide = 128;
    ASSERT_GT(file.size(), size_t(kSide) * kSide);
    const std::string bytes = file.substr(file.size() - size_t(kSide) * kSide);
    Grid grid(kSide, kSide);
    double mean = 0;
    for (const char c : bytes) mean += double(uint8_t(c)) / double(bytes.size());
    for (size_t i = 0; i < bytes.size(); ++i) grid.values[i] = double(uint8_t(bytes[i])) - mean;
    const GridSpectrum spectrum(grid);
    double energy = 0, x = 0, y = 0;
    for (int j = 0; j < kSide; ++j)
        for (int i = 0; i < kSide; ++i) {
            const double e = std::norm(spectrum.at(i, j));
            energy += e;
            x += e * std::pow(kSide * spectrum.frequency_x(i), 2);
            y += e * std::pow(kSide * spectrum.frequency_y(j), 2);
        }
    // Energies vary half as widely as amplitudes; clipping and 8 bits add little.
    EXPECT_NEAR(std::sqrt(2 * x / energy), MovingPattern::kBandwidth, 0.1);
    EXPECT_NEAR(std::sqrt(2 * y / energy), MovingPattern::kBandwidth, 0.1);
}

TEST(SphereRows, CirclesAreInsideTheImageAndApart) {
    const SphereRows rows;
    EXPECT_TRUE(read_pbrt_string(rows.text({300, 135}), "shininess").warnings.empty());
    double last = -1e9;
    for (int i = 0; i < int(SphereRows::kExponents.size()); ++i) {
        const auto [x, y, r] = rows.circle(0, i, {300, 135});
        EXPECT_GT(x - r, std::max(0.0, last));
        EXPECT_LT(x + r, 300);
        EXPECT_GT(y - r, 0);
        EXPECT_LT(y + r, 0.5 * 135);
        last = x + r;
    }
    EXPECT_DOUBLE_EQ(SphereRows::roughness(64), 0.125);
}

TEST(SceneSource, NamesAGivenFolderThatLacksAScene) {
    SceneSource source("/nowhere", std::filesystem::temp_directory_path() / "covtrace-scenes");
    try {
        source.generated("snooker");
        FAIL() << "expected an error";
    } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::scene);
        EXPECT_NE(std::string(e.what()).find("/nowhere/snooker/scene.pbrt"), std::string::npos);
    }
}

TEST(SceneSource, SaysWhyTheGeneratorFailed) {
    const auto folder = std::filesystem::temp_directory_path() / "covtrace-scenes";
    SceneSource source({}, folder);
    try {
        source.generated("no-such-scene");
        FAIL() << "expected an error";
    } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::scene);
        EXPECT_NE(std::string(e.what()).find("unknown scene 'no-such-scene'"), std::string::npos)
            << e.what();
    }
    std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace covtrace::reproduce
