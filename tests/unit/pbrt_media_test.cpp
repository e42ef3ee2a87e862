/// Participating media of scene files.
#include "pbrt_test_support.h"

namespace covtrace::test {
namespace {

TEST(SceneMedia, AreRead) {
    const auto scene = read_world(
        "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [ 1 2 3 ] \"rgb "
        "sigma_s\" [ 0 0 0 ] \"float scale\" 2 \"float g\" .5\n"
        "MakeNamedMedium \"default\" \"string type\" \"homogeneous\" \"rgb Le\" [ 1 2 4 ] "
        "\"float Lescale\" .5\n"
        "MakeNamedMedium \"milk\" \"string type\" \"homogeneous\" \"string preset\" \"Wholemilk\" "
        "\"float scale\" 10\n"
        "MakeNamedMedium \"cloud\" \"string type\" \"cloud\" \"float frequency\" 0.5\n"
        "MakeNamedMedium \"smoke\" \"string type\" \"uniformgrid\" \"integer nx\" 2 \"float "
        "density\" [ 1 2 ] \"rgb sigma_a\" [ 1 1 2 ]\n"
        "MakeNamedMedium \"dye\" \"string type\" \"rgbgrid\" \"integer nz\" 2 \"rgb sigma_a\" [ 1 "
        "2 "
        "3 3 4 5 ]\n"
        "MakeNamedMedium \"odd\" \"string type\" \"homogeneous\" \"string preset\" "
        "\"Wholemilc\"\n");
    ASSERT_EQ(scene.media.size(), 7u);
    EXPECT_EQ(scene.media[0].sigma_a, (Rgb{2, 4, 6}));
    EXPECT_TRUE(is_black(scene.media[0].sigma_s));
    EXPECT_TRUE(is_black(scene.media[0].emission));
    EXPECT_EQ(scene.media[0].g, 0.5f);
    EXPECT_EQ(scene.media[1].sigma_a, Rgb{1});
    EXPECT_EQ(scene.media[1].sigma_s, Rgb{1});
    EXPECT_EQ(scene.media[1].emission, (Rgb{0.5f, 1, 2}));
    EXPECT_FLOAT_EQ(scene.media[2].sigma_s.g, 32.1f);
    EXPECT_FLOAT_EQ(scene.media[2].sigma_a.b, 0.14f);
    EXPECT_EQ(scene.media[3].sigma_a, Rgb{1});
    ASSERT_TRUE(scene.media[3].density);
    EXPECT_EQ(scene.media[3].density->at({0.5f, 0, 0.5f}), 1);
    EXPECT_EQ(scene.media[4].sigma_a, (Rgb{1, 1, 2}));
    EXPECT_EQ(scene.media[4].sigma_s, Rgb{1});
    ASSERT_TRUE(scene.media[4].density);
    EXPECT_FLOAT_EQ(scene.media[4].density->at({0.25f, 0.5f, 0.5f}), 1);
    EXPECT_FLOAT_EQ(scene.media[4].density->at({0.5f, 0.5f, 0.5f}), 1.5f);
    EXPECT_FLOAT_EQ(scene.media[4].density->at({0.75f, 0.5f, 0.5f}), 2);
    // Colours are the mean; cells have 9 and 15 of the mean extinction of 12
    EXPECT_EQ(scene.media[5].sigma_a, (Rgb{2, 3, 4}));
    EXPECT_EQ(scene.media[5].sigma_s, Rgb{1});
    EXPECT_FLOAT_EQ(scene.media[5].density->at({0.5f, 0.5f, 0.25f}), 9.0f / 12);
    EXPECT_FLOAT_EQ(scene.media[5].density->at({0.5f, 0.5f, 0.75f}), 15.0f / 12);
    EXPECT_EQ(scene.warnings.size(), 2u) << warnings_of(scene);
    EXPECT_TRUE(contains(warnings_of(scene), "did you mean \"Wholemilk\"")) << warnings_of(scene);
}

TEST(SceneMedia, ColouredGridsEmitWhatTheirCellsAbsorb) {
    const std::string grid =
        "MakeNamedMedium \"m\" \"string type\" \"rgbgrid\" \"integer nx\" 2 \"float scale\" 3 "
        "\"float Lescale\" 10 \"rgb Le\" [ 1 2 3  4 5 6 ] ";
    const SceneDescription scene = read_world(grid + "\"rgb sigma_a\" [ 1 0 1  2 2 0 ]");
    ASSERT_TRUE(scene.media.at(0).source);
    const EmissionField& light = *scene.media[0].source;
    EXPECT_EQ(light.at({0.25f, 0.5f, 0.5f}), (Rgb{30, 0, 90}));
    EXPECT_EQ(light.at({0.75f, 0.5f, 0.5f}), (Rgb{240, 300, 0}));
    EXPECT_FALSE(contains(warnings_of(scene), "emit")) << warnings_of(scene);
    EXPECT_TRUE(contains(world_error(grid + "\"rgb sigma_s\" [ 1 0 1  2 2 0 ]"),
                         "expected \"rgb sigma_a\" beside it"));
}

TEST(SceneMedia, ColouredGridsAreOfTheFilesColourSpace) {
    const std::string grid =
        "MakeNamedMedium \"m\" \"string type\" \"rgbgrid\" \"rgb sigma_a\" [ .2 .5 .3 ]\n"
        "MakeNamedMedium \"n\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [ .2 .5 .3 ]";
    const SceneDescription scene = read_world("ColorSpace \"rec2020\"\n" + grid);
    EXPECT_LT(scene.media.at(0).sigma_a.r, 0.1f);
    EXPECT_EQ(scene.media[0].sigma_a, scene.media[1].sigma_a);
}

TEST(SceneMedia, HotMediaAreAsBrightAsPbrts) {
    // Means of 24x24 pixels of pbrt-v4, 256 samples each: an opaque ball of this
    // temperature fills the picture, "Lescale" is 1 in each cell
    struct Case {
        const char* kelvin;
        Rgb radiance;
    };
    for (const Case& c : {Case{"3000", {78.7201f, 37.5358f, 12.0992f}},
                          Case{"5772", {114.467f, 100.3453f, 93.9264f}}}) {
        const SceneDescription scene =
            read_world(std::string("MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" ") +
                       "\"float density\" 1 \"float temperature\" " + c.kelvin);
        SCOPED_TRACE(c.kelvin);
        expect_near(scene.media.at(0).glow->at({0.5f, 0.5f, 0.5f}), c.radiance,
                    0.02f * max_component(c.radiance));
    }
}

TEST(SceneMedia, LescaleIsAFactorOfHotMediaToo) {
    const std::string hot =
        "\"string type\" \"uniformgrid\" \"integer nx\" 2 \"float density\" [ 1 1 ] "
        "\"float temperature\" [ 2000 2000 ] ";
    const SceneDescription scene = read_world(
        "MakeNamedMedium \"plain\" " + hot + "\nMakeNamedMedium \"even\" " + hot +
        "\"float Lescale\" 3\nMakeNamedMedium \"varied\" " + hot + "\"float Lescale\" [ 3 6 ]\n");
    ASSERT_EQ(scene.media.size(), 3u);
    EXPECT_TRUE(scene.warnings.empty()) << warnings_of(scene);
    const auto light = [&](size_t medium, float x) {
        return scene.media[medium].glow->at({x, 0.5f, 0.5f}).r;
    };
    const float plain = light(0, 0.25f);
    EXPECT_GT(plain, 0);
    EXPECT_FLOAT_EQ(light(1, 0.25f), 3 * plain);
    EXPECT_FLOAT_EQ(light(2, 0.25f), 3 * plain);
    EXPECT_FLOAT_EQ(light(2, 0.75f), 6 * plain);
}

}  // namespace
}  // namespace covtrace::test
