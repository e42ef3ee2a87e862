// One feature of pbrt-v4 per file of scenes/tests: each says at its head what its image is.
#include <gtest/gtest.h>

#include <array>
#include <set>

#include "tests/render/fixtures.h"

namespace covtrace {
namespace {

using namespace test;

enum class Where { everywhere, middle, corners };

struct Known {
    const char* file;
    Where where;
    Rgb value;
    double model = 2e-3;  ///< relative error that the value itself may have
};

void PrintTo(const Known& k, std::ostream* out) {
    *out << k.file;
}

/// Means over the block, and their standard errors, channel by channel.
struct Block {
    Rgb mean, error;
};

Block block(const Image& image, Where where) {
    double sum[3] = {}, variance[3] = {}, n = 0;
    const int w = image.width(), h = image.height();
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
            const bool middle = 8 * x >= 3 * w && 8 * x < 5 * w && 8 * y >= 3 * h && 8 * y < 5 * h;
            const bool corner = (8 * x < w || 8 * x >= 7 * w) && (8 * y < h || 8 * y >= 7 * h);
            if ((where == Where::middle && !middle) || (where == Where::corners && !corner))
                continue;
            const size_t i = size_t(y) * size_t(w) + size_t(x);
            const Rgb c = image.rgb(i), v = image.rgb(i, "variance.");
            for (int k = 0; k < 3; ++k) sum[k] += c[k], variance[k] += v[k];
            ++n;
        }
    const auto mean = [&](int k) { return float(sum[k] / n); };
    const auto error = [&](int k) { return float(std::sqrt(variance[k]) / n); };
    return {{mean(0), mean(1), mean(2)}, {error(0), error(1), error(2)}};
}

Image render_file(const std::string& name, double spp) {
    RenderScene scene(
        read_pbrt(std::filesystem::path(COVTRACE_SCENES_FOLDER) / "tests" / (name + ".pbrt")));
    Monitor monitor;
    return render(scene, uniform(spp, 3), monitor).image;
}

class Corpus : public testing::TestWithParam<Known> {};

// Each channel must agree within 5 standard errors (false alarm 6e-7) and the value's own error.
TEST_P(Corpus, ShowsItsValue) {
    const Known& k = GetParam();
    const Image image = render_file(k.file, 64);
    EXPECT_EQ(summarize_image(image).nonfinite, 0);
    const Block b = block(image, k.where);
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(b.mean[c], k.value[c], 5 * b.error[c] + k.model * k.value[c] + 1e-6)
            << "channel " << c;
}

constexpr Rgb kLit{0.5f * 2 * kInvPi}, kCoatedRed{0.5530f, 0.0963f, 0.0454f};

INSTANTIATE_TEST_SUITE_P(
    Scenes, Corpus,
    testing::Values(Known{"camera-orthographic", Where::everywhere, Rgb(0.25f)},
                    Known{"camera-perspective", Where::everywhere, Rgb(0.1875f)},
                    Known{"camera-screenwindow", Where::everywhere, Rgb(0.0625f)},
                    Known{"camera-spherical", Where::everywhere, Rgb(0.0669873f)},
                    Known{"camera-equirectangular", Where::everywhere, Rgb(1 / 6.0f)},
                    Known{"camera-moving", Where::everywhere, Rgb(0.75f)},
                    Known{"camera-realistic", Where::everywhere, Rgb(3.785e-03f), 4e-3},
                    Known{"material-measured", Where::everywhere, Rgb(0.5f), 0.02},
                    Known{"material-measured-metal", Where::everywhere, Rgb(0.9947f), 2e-3},
                    Known{"shape-displacement", Where::everywhere, Rgb(0.25f), 1e-4},
                    Known{"shape-tangents", Where::everywhere, kLit},
                    Known{"film-gbuffer", Where::everywhere, Rgb(0.5f)},
                    Known{"film-iso", Where::everywhere, Rgb(2.5f)},
                    Known{"film-exposure", Where::everywhere, Rgb(0.25f)},
                    Known{"film-maxcomponentvalue", Where::everywhere, {3.1432f, 1.5716f, 0.7858f}},
                    Known{"film-whitebalance", Where::everywhere, Rgb(1), 0.02},
                    Known{"film-sensor", Where::everywhere, {0.9878f, 0.9919f, 0.9956f}, 2e-3},
                    Known{"film-sensor-glow", Where::everywhere, {2.1096f, 0.7912f, 0.1876f}, 3e-3},
                    Known{"light-point", Where::everywhere, kLit},
                    Known{"light-point-power", Where::everywhere, kLit},
                    Known{"light-spot", Where::corners, Rgb(0)},
                    Known{"light-spot-power", Where::corners, Rgb(0)},
                    Known{"light-goniometric", Where::everywhere, kLit},
                    Known{"light-goniometric-power", Where::everywhere, kLit},
                    Known{"light-projection-power", Where::everywhere, kLit},
                    Known{"light-distant", Where::everywhere, 0.5f * kLit},
                    Known{"light-distant-illuminance", Where::everywhere, 0.5f * kLit},
                    Known{"light-infinite-illuminance", Where::everywhere, Rgb(0.5f)},
                    Known{"light-infinite-image", Where::everywhere, Rgb(1), 0.02},
                    Known{"light-infinite-image-illuminance", Where::everywhere, Rgb(1), 0.01},
                    Known{"light-portal", Where::everywhere, Rgb(0.239456f)},
                    Known{"light-moving", Where::everywhere, kLit},
                    Known{"light-area-moving", Where::everywhere, Rgb(0.0463947f)},
                    Known{"light-area-object", Where::everywhere, Rgb(0.875f)},
                    Known{"light-scale", Where::everywhere, 0.375f * kLit},
                    Known{"light-area-power", Where::everywhere, Rgb(1)},
                    Known{"light-area-twosided", Where::everywhere, Rgb(0.5f)},
                    Known{"light-area-image", Where::everywhere, Rgb(0.5f), 5e-3},
                    Known{"light-area-alpha-0", Where::everywhere, Rgb(0.5f)},
                    Known{"light-area-image-lit", Where::everywhere, Rgb(0.4f)},
                    Known{"alpha-constant", Where::middle, Rgb(0.7f)},
                    Known{"alpha-constant", Where::corners, Rgb(1)},
                    Known{"alpha-emission", Where::middle, Rgb(0.3f)},
                    Known{"alpha-texture", Where::everywhere, Rgb(0.5f)},
                    Known{"alpha-shadow", Where::everywhere, 0.75f * 2 * 0.70710678f * kLit},
                    Known{"bump-ramp", Where::everywhere, 0.8f * kLit},
                    Known{"normal-map", Where::everywhere, kLit},
                    Known{"furnace-coatedconductor", Where::middle, Rgb(1)},
                    Known{"furnace-coateddiffuse-gap", Where::everywhere, Rgb(1)},
                    Known{"furnace-dispersion", Where::everywhere, Rgb(1)},
                    Known{"integrator-regularize", Where::everywhere, Rgb(0.489408f), 5e-3},
                    Known{"furnace-mix", Where::middle, Rgb(0.35f)},
                    Known{"furnace-thindielectric", Where::everywhere, Rgb(1)},
                    Known{"furnace-interface", Where::everywhere, Rgb(1)},
                    Known{"material-thindielectric", Where::everywhere, Rgb(0.923077f)},
                    Known{"material-coat-coloured", Where::everywhere, kCoatedRed, 0.02},
                    Known{"material-coat-gap-coloured", Where::everywhere,
                          Rgb(0.4186f, 0.1861f, 0.1068f), 0.012},
                    Known{"material-mix-texture", Where::everywhere, Rgb(0.5f)},
                    Known{"material-conductor-spectrum", Where::everywhere,
                          Rgb(0.97f, 0.96f, 0.92f), 0.02},
                    Known{"texture-imagemap", Where::everywhere, Rgb(0.35793f)},
                    Known{"texture-checkerboard", Where::everywhere, Rgb(0.5f)},
                    Known{"texture-dots", Where::everywhere, Rgb(0.7095f), 1e-2},
                    Known{"texture-scale", Where::everywhere, Rgb(0.4f)},
                    Known{"texture-mix", Where::everywhere, Rgb(0.5f)},
                    Known{"texture-minified", Where::everywhere, {0.55f, 0.3f, 0.55f}, 5e-3},
                    Known{"material-mix-interface", Where::everywhere, 0.25f * kLit},
                    Known{"media-coloured", Where::everywhere, {0.162867f, 0.483043f, 0.833498f}},
                    Known{"light-area-far", Where::everywhere, Rgb(0.5f)},
                    Known{"shape-disk", Where::everywhere, Rgb(0.1963495f)},
                    Known{"shape-cylinder", Where::everywhere, Rgb(0.75f)},
                    Known{"shape-bilinearmesh", Where::everywhere, Rgb(0.75f)},
                    Known{"shape-loopsubdiv", Where::everywhere, Rgb(0.908605f), 0.0335},
                    Known{"shape-plymesh-gz", Where::everywhere, Rgb(0.75f)},
                    Known{"instances", Where::everywhere, Rgb(0.9018252f)},
                    Known{"motion", Where::everywhere, Rgb(0.75f)},
                    Known{"coordinate-system", Where::everywhere, Rgb(0.25f)}));

TEST(CorpusFile, SpotLightsItsMiddle) {
    for (const char* name : {"light-spot", "light-spot-power"}) {
        const Image image = render_file(name, 16);
        // The two by two pixels about the centre are up to 2.5 degrees off the axis.
        const size_t i = size_t(image.height() / 2 * image.width() + image.width() / 2);
        EXPECT_NEAR(image.rgb(i).g, kLit.g, 0.01f * kLit.g) << name;
    }
}

TEST(CorpusFile, SlideStandsUpright) {
    const Image image = render_file("light-projection", 16);
    const auto at = [&](int x, int y) { return image.rgb(size_t(y * image.width() + x)); };
    const int last = image.width() - 1;
    // The fall-off cos^4 is (4 / 4.3)^2 in a corner of the view.
    const auto near = [](Rgb seen, Rgb expected) {
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c], expected[c], 0.03f);
    };
    const float lit = 0.8653f * kLit.g;
    near(at(0, 0), {lit, 0, 0});
    near(at(last, 0), {0, lit, 0});
    near(at(0, last), {0, 0, lit});
    near(at(last, last), Rgb(lit));
}

TEST(CorpusFile, PrismPartsColours) {
    const Block b = block(render_file("material-dispersion", 1024), Where::everywhere);
    const std::array<float, 3> expected{1.02711f, 0.29488f, -0.05315f};
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(b.mean[c], expected[size_t(c)], 5 * b.error[c] + 3e-3f) << "channel " << c;
}

TEST(CorpusFile, GbufferTellsWhatIsSeen) {
    const Image image = render_file("film-gbuffer", 16);
    const size_t i = size_t(image.height() / 2 * image.width() + image.width() / 2);
    const auto is = [&](const char* channel, float expected, float within) {
        const Channel* c = image.find(channel);
        ASSERT_NE(c, nullptr) << channel;
        EXPECT_NEAR(c->values[i], expected, within) << channel;
    };
    is("albedo.G", 0.5f, 1e-4f);
    is("P.Z", 4, 1e-4f);
    is("Ng.Z", -1, 1e-6f);
    is("N.Z", -1, 1e-6f);
    // The pixel right of and below the middle: u grows with x, v with y; half a pixel is 1/128.
    is("uv.X", 0.5f + 1 / 128.0f, 1e-2f);
    is("uv.Y", 0.5f - 1 / 128.0f, 1e-2f);
}

TEST(CorpusFile, ColouredLightHasLuminanceOne) {
    for (const char* name : {"light-blackbody", "light-illuminant"}) {
        const Block b = block(render_file(name, 64), Where::everywhere);
        EXPECT_NEAR(luminance(b.mean), 0.5f, 5 * b.error.g + 1e-3f) << name;
        EXPECT_GT(b.mean.r, b.mean.g) << name;
        EXPECT_GT(b.mean.g, b.mean.b) << name;
    }
}

TEST(CorpusFile, RoughMetalUnderACoatLosesLittle) {
    // GGX alone keeps 0.97 at this roughness (bsdf/ggx.h); a refracted view is steeper.
    const Block b = block(render_file("furnace-coatedconductor-rough", 256), Where::middle);
    EXPECT_LE(b.mean.g, 1 + 5 * b.error.g + 1e-3f);
    EXPECT_GE(b.mean.g, 0.96f);
}

TEST(CorpusFile, HairIsAsBrightAsInPbrt) {
    // The means are pbrt-v4's, whose channels are spectra.
    const Block b = block(render_file("material-hair", 64), Where::everywhere);
    const Rgb expected(0.8546f, 0.7929f, 0.7025f);
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(b.mean[c], expected[c], 0.005f * expected[c] + 5 * b.error[c]);
}

TEST(CorpusFile, MarbleSendsBackNearlyAllLight) {
    const Block b = block(render_file("material-subsurface", 64), Where::middle);
    for (int c = 0; c < 3; ++c) {
        EXPECT_GT(b.mean[c], 0.97f);
        EXPECT_LT(b.mean[c], 1 + 5 * b.error[c]);
    }
}

// Every file of the folder opens; only these ask for what is replaced or left out.
TEST(CorpusFile, OnlySubstitutesWarn) {
    const std::set<std::string> replaced{"shape-cylinder", "light-moving", "light-area-object"};
    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(
             std::filesystem::path(COVTRACE_SCENES_FOLDER) / "tests")) {
        if (entry.path().extension() != ".pbrt") continue;
        ++count;
        const SceneDescription scene = read_pbrt(entry.path());
        EXPECT_EQ(!scene.warnings.empty(), replaced.count(entry.path().stem()) > 0) << entry.path();
    }
    EXPECT_GE(count, 60);
}

}  // namespace
}  // namespace covtrace
