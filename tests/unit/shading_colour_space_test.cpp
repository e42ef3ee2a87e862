// Images whose primaries are not those of Rec.709, in every place that reads them.
#include <gtest/gtest.h>

#include "core/colour_space.h"
#include "light_fixtures.h"
#include "texture/texture.h"

namespace covtrace {
namespace {

using namespace test;

const std::vector<float> kRec709{0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f};
const std::vector<float> kRec2020{0.708f, 0.292f, 0.17f, 0.797f, 0.131f, 0.046f, 0.3127f, 0.329f};
const std::vector<float> kAces{0.7347f, 0.2653f, 0, 1, 0.0001f, -0.077f, 0.32168f, 0.33767f};
const std::vector<float> kAcesCg{0.713f, 0.293f, 0.165f, 0.83f, 0.128f, 0.044f, 0.32168f, 0.33767f};
const Rgb kColour{0.5f, 0.6f, 0.4f};

/// An even picture of kColour.
struct Picture : TemporaryImage {
    explicit Picture(const std::vector<float>& chromaticities)
        : TemporaryImage(std::vector<Rgb>(16, kColour), 4, 4, {{kChromaticities, chromaticities}}) {
    }
};

void expect_equal(Rgb a, Rgb b) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 1e-5f) << "channel " << c;
}

enum class Use { colour, number, direction };

TextureDescription texture(const Picture& picture, Use use) {
    ImageTexture t;
    t.file = picture.path();
    t.is_colour = use != Use::direction;
    return {{}, use != Use::number, t, {}};
}

TEST(ColourSpaces, AreKnownByTheirChromaticities) {
    const auto space = [](std::vector<float> values) {
        Chromaticities c{};
        std::copy(values.begin(), values.end(), c.begin());
        return colour_space_with(c);
    };
    EXPECT_EQ(space(kRec709), ColourSpace::srgb);
    EXPECT_EQ(space(kRec2020), ColourSpace::rec2020);
    EXPECT_EQ(space(kAces), ColourSpace::aces2065_1);
    EXPECT_EQ(space({0.68f, 0.32f, 0.265f, 0.69f, 0.15f, 0.06f, 0.31271f, 0.32902f}),
              ColourSpace::dci_p3);
    EXPECT_EQ(space({0.7347f, 0.2653f, 0, 1, 0, -0.077f, 0.32168f, 0.33767f}),
              ColourSpace::aces2065_1);
    EXPECT_EQ(space(kAcesCg), std::nullopt);
    EXPECT_EQ(space({0.641f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f}), std::nullopt);
}

TEST(ColourSpaces, OfTexturesAreThoseOfTheirColoursAlone) {
    const Picture rec2020(kRec2020), plain(kRec709);
    SceneDescription scene;
    for (const Use use : {Use::direction, Use::number, Use::colour})
        scene.textures.push_back(texture(rec2020, use));
    scene.textures.push_back(texture(plain, Use::colour));
    const TextureStore store(scene);
    const TexturePoint at{{0.5f, 0.5f}, {}};
    expect_equal(store.eval(0, at), kColour);
    EXPECT_NEAR(store.eval_float(1, at), 0.5f, 1e-5f);
    expect_equal(store.eval(2, at), to_rec709(kColour, ColourSpace::rec2020));
    expect_equal(store.mean(2), to_rec709(kColour, ColourSpace::rec2020));
    expect_equal(store.eval(3, at), kColour);
    EXPECT_TRUE(store.warnings().empty());
}

TEST(ColourSpaces, ThatAreNotKnownAreTakenForSrgbWithAWarning) {
    const Picture picture(kAcesCg);
    SceneDescription scene;
    scene.textures.push_back(texture(picture, Use::number));
    EXPECT_TRUE(TextureStore(scene).warnings().empty());
    scene.textures.push_back(texture(picture, Use::colour));
    scene.textures.push_back(texture(picture, Use::colour));
    const TextureStore store(scene);
    expect_equal(store.eval(1, {{0.5f, 0.5f}, {}}), kColour);
    ASSERT_EQ(store.warnings().size(), 1u);
    EXPECT_NE(store.warnings()[0].text.find("chromaticities"), std::string::npos);
}

/// A sky with this picture, built.
void build_sky(LightScene& scene, const Picture& picture) {
    InfiniteLight sky;
    sky.image = picture.path();
    scene.add_light(sky);
    scene.build();
}

TEST(ColourSpaces, OfTheSky) {
    for (const auto& [chromaticities, space] :
         {std::pair{kRec2020, ColourSpace::rec2020}, std::pair{kAces, ColourSpace::aces2065_1}}) {
        const Picture picture(chromaticities);
        LightScene scene;
        build_sky(scene, picture);
        expect_equal(scene.lights->environment({}, {0, 0, 1}), to_rec709(kColour, space));
        EXPECT_TRUE(scene.lights->warnings().empty());
    }
    const Picture picture(kAcesCg);
    LightScene scene;
    build_sky(scene, picture);
    expect_equal(scene.lights->environment({}, {0, 0, 1}), kColour);
    EXPECT_EQ(scene.lights->warnings().size(), 1u);
}

TEST(ColourSpaces, OfSlidesAndOfGoniometricImagesWhichAreFactors) {
    const Picture picture(kRec2020);
    LightScene scene;
    ProjectionLight slide;
    slide.image = picture.path();
    slide.scale = 1;
    slide.fov = 90;
    scene.add_light(slide);
    GoniometricLight round;
    round.image = picture.path();
    round.intensity = Rgb(1);
    scene.add_light(round, Transform::translate({0, 0, 100}));
    scene.build();
    const auto radiance = [&](Vec3 p) {
        Rgb nearest;
        for (const float u : {0.01f, 0.99f})
            if (const auto s = scene.lights->sample(p, {}, 0, u, {0.5f, 0.5f});
                s && s->distance < 2)
                nearest = s->radiance;
        return nearest;
    };
    expect_equal(radiance({0, 0, 1}), to_rec709(kColour, ColourSpace::rec2020));
    expect_equal(radiance({0, 0, 101}), Rgb(0.5f));
}

}  // namespace
}  // namespace covtrace
