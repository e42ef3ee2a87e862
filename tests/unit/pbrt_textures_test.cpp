#include "pbrt_test_support.h"

namespace covtrace::test {
namespace {

/// The texture "t" of the text.
const TextureDescription& texture(const SceneDescription& scene, const std::string& name = "t") {
    for (const TextureDescription& t : scene.textures)
        if (t.name == name) return t;
    throw std::runtime_error("no texture");
}

TEST(SceneTextures, ImagesHaveMappingAndOptions) {
    const TemporaryFolder folder;
    const auto image = folder.write("a image.tga", "");
    folder.write("b.png", "");
    const auto main =
        folder.write("main.pbrt",
                     "WorldBegin Translate 1 0 0\nTexture \"t\" \"spectrum\" \"imagemap\" \"string "
                     "filename\" \"a image.tga\"\n"
                     "\"float uscale\" 2 \"float vscale\" 3 \"float udelta\" .1 \"float vdelta\" "
                     ".2 \"string wrap\" \"clamp\"\n"
                     "\"string filter\" \"trilinear\" \"float scale\" .5 \"bool invert\" true "
                     "\"float maxanisotropy\" 4\n"
                     "Texture \"g\" \"float\" \"imagemap\" \"string filename\" \"b.png\"\n"
                     "Texture \"e\" \"float\" \"imagemap\" \"string filename\" \"b.png\" \"string "
                     "encoding\" \"gamma 2.2\" \"string mapping\" \"planar\"\n"
                     "\"vector3 v1\" [ 0 0 1 ]\n");
    const auto scene = read_pbrt(main);
    const auto& t = std::get<ImageTexture>(texture(scene).value);
    EXPECT_EQ(t.file, image.lexically_normal());
    EXPECT_EQ(t.mapping.scale_u, 2);
    EXPECT_EQ(t.mapping.scale_v, 3);
    EXPECT_EQ(t.mapping.delta_u, 0.1f);
    EXPECT_EQ(t.mapping.delta_v, 0.2f);
    EXPECT_EQ(t.wrap, ImageTexture::Wrap::clamp);
    EXPECT_EQ(t.filter, ImageTexture::Filter::trilinear);
    EXPECT_EQ(t.scale, 0.5f);
    EXPECT_TRUE(t.invert);
    EXPECT_FALSE(t.encoding.has_value());
    EXPECT_EQ(std::get<ImageTexture>(texture(scene, "g").value).encoding,
              ImageTexture::Encoding::srgb);
    EXPECT_FALSE(texture(scene, "g").is_spectrum);
    const auto& e = std::get<ImageTexture>(texture(scene, "e").value);
    EXPECT_EQ(e.encoding, ImageTexture::Encoding::gamma);
    EXPECT_EQ(e.gamma, 2.2f);
    EXPECT_EQ(e.mapping.kind, TextureMapping::Kind::planar);
    EXPECT_EQ(e.mapping.v1, (Vec3{0, 0, 1}));
    expect_near(e.mapping.texture_from_world.point({1, 0, 0}), {0, 0, 0}, 0);
    EXPECT_TRUE(scene.warnings.empty()) << warnings_of(scene);
}

TEST(SceneTextures, CheckerboardsScalesAndMixesHoldOthers) {
    const auto scene = read_world(
        "Texture \"t\" \"spectrum\" \"checkerboard\" \"rgb tex1\" [ .1 .2 .3 ] \"texture tex2\" "
        "\"s\" \"float uscale\" 20\n"
        "Texture \"s\" \"spectrum\" \"scale\" \"rgb tex\" [ .4 .4 .4 ] \"float scale\" 3\n"
        "Texture \"m\" \"float\" \"mix\" \"float tex1\" .2 \"float amount\" .25\n"
        "Texture \"d\" \"float\" \"checkerboard\" \"integer dimension\" 3\n");
    const auto& c = std::get<CheckerboardTexture>(texture(scene).value);
    EXPECT_EQ(c.dimension, 2);
    EXPECT_EQ(c.mapping.scale_u, 20);
    EXPECT_EQ(constant_value(scene, c.tex1), (Rgb{0.1f, 0.2f, 0.3f}));
    const auto& s = constant_as<ScaleTexture>(scene, c.tex2);
    EXPECT_EQ(constant_value(scene, s.tex), Rgb{0.4f});
    EXPECT_EQ(constant_value(scene, s.scale), Rgb{3});
    const auto& m = std::get<MixTexture>(texture(scene, "m").value);
    EXPECT_EQ(constant_value(scene, m.tex1), Rgb{0.2f});
    EXPECT_EQ(constant_value(scene, m.tex2), Rgb{1});
    EXPECT_EQ(constant_value(scene, m.amount), Rgb{0.25f});
    EXPECT_EQ(std::get<CheckerboardTexture>(texture(scene, "d").value).dimension, 3);
    EXPECT_TRUE(scene.warnings.empty()) << warnings_of(scene);
}

TEST(SceneTextures, EqualInlineValuesAreShared) {
    const auto scene = read_world(
        "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" \"rgb reflectance\" [ .1 .1 .1 ]\n"
        "MakeNamedMaterial \"b\" \"string type\" \"diffuse\" \"rgb reflectance\" [ .1 .1 .1 ]\n");
    const auto id = [&](size_t i) {
        return std::get<DiffuseMaterial>(scene.materials.at(i).value).reflectance;
    };
    EXPECT_EQ(id(1), id(2));
    EXPECT_NE(id(0), id(1));
}

TEST(SceneTextures, FloatAndSpectrumNamesAreApart) {
    const auto scene =
        read_world("Texture \"t\" \"float\" \"constant\"\nTexture \"t\" \"spectrum\" \"constant\"");
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(SceneTextures, OthersBecomeTheirMeanWithAWarning) {
    for (const char* text : {"\"float\" \"ptex\" \"string filename\" \"x\"",
                             "\"spectrum\" \"ptex\" \"string filename\" \"x\""}) {
        const auto scene = read_world(std::string("Texture \"t\" ") + text);
        EXPECT_TRUE(std::holds_alternative<ConstantTexture>(texture(scene).value)) << text;
        EXPECT_EQ(scene.warnings.size(), 1u) << text << "\n" << warnings_of(scene);
    }
}

TEST(SceneTextures, DirectionmixIsAMixByTheNormal) {
    const auto scene = read_world(
        "Rotate 90 0 0 1\n"
        "Texture \"t\" \"float\" \"directionmix\" \"float tex1\" 2 \"float tex2\" 4 \"vector3 "
        "dir\" [ 3 0 0 ]");
    EXPECT_TRUE(scene.warnings.empty()) << warnings_of(scene);
    const auto& mix = std::get<MixTexture>(texture(scene).value);
    const auto part = [&](TextureId id) { return scene.textures.at(size_t(id)).value; };
    EXPECT_EQ(std::get<ConstantTexture>(part(mix.tex1)).value, Rgb{2});
    EXPECT_EQ(std::get<ConstantTexture>(part(mix.tex2)).value, Rgb{4});
    expect_near(std::get<AsideTexture>(part(mix.amount)).direction, {0, 1, 0}, 1e-6f);
    const auto usual = read_world("Texture \"t\" \"spectrum\" \"directionmix\"");
    const auto& amount =
        usual.textures.at(size_t(std::get<MixTexture>(texture(usual).value).amount));
    expect_near(std::get<AsideTexture>(amount.value).direction, {0, 1, 0}, 1e-6f);
    EXPECT_TRUE(
        contains(world_error("Texture \"t\" \"float\" \"directionmix\" \"vector3 dir\" [ 0 0 0 ]"),
                 "must not be zero"));
}

TEST(SceneTextures, FacingTakesTexturesByTheCosine) {
    const std::string parts =
        "Texture \"a\" \"float\" \"constant\" \"float value\" 0.1\n"
        "Texture \"b\" \"float\" \"constant\" \"float value\" 0.2\n"
        "Texture \"c\" \"spectrum\" \"constant\"\n"
        "Texture \"t\" \"float\" \"facing\" ";
    const auto scene = read_world(
        parts + "\"string textures\" [ \"a\" \"b\" \"a\" ] \"float cosines\" [ 0.1 0.3 0.9 ]");
    EXPECT_TRUE(scene.warnings.empty()) << warnings_of(scene);
    const auto& facing = std::get<FacingTexture>(texture(scene).value);
    EXPECT_EQ(facing.cosines, (std::vector<float>{0.1f, 0.3f, 0.9f}));
    ASSERT_EQ(facing.textures.size(), 3u);
    EXPECT_EQ(scene.textures[size_t(facing.textures[1])].name, "b");
    EXPECT_EQ(facing.textures[0], facing.textures[2]);
    const auto even = read_world(parts + "\"string textures\" [ \"a\" \"b\" \"a\" ]");
    EXPECT_EQ(std::get<FacingTexture>(texture(even).value).cosines,
              (std::vector<float>{0, 0.5f, 1}));
    for (const auto& [text, expected] : std::initializer_list<std::pair<const char*, const char*>>{
             {"", "names of textures"},
             {"\"string textures\" \"c\"", "of this name is of type spectrum"},
             {"\"string textures\" [ \"a\" \"b\" ] \"float cosines\" [ 0 0.5 1 ]",
              "each of its 2 textures"},
             {"\"string textures\" [ \"a\" \"b\" ] \"float cosines\" [ 0.5 0.5 ]",
              "each above the one before"},
             {"\"string textures\" [ \"a\" \"b\" ] \"float cosines\" [ 0 1.5 ]", "from -1 to 1"},
             {"\"string textures\" [ \"a\" \"t\" ]", "refers to itself"}})
        EXPECT_TRUE(contains(world_error(parts + text), expected)) << text;
}

TEST(SceneTextures, NoiseTakesItsParameters) {
    const auto noise = [](const std::string& text) {
        const auto scene = read_world("Scale 2 2 2\nTexture \"t\" " + text);
        EXPECT_TRUE(scene.warnings.empty()) << warnings_of(scene);
        return std::get<NoiseTexture>(texture(scene).value);
    };
    const NoiseTexture fbm =
        noise("\"float\" \"fbm\" \"integer octaves\" 3 \"float roughness\" 0.7");
    EXPECT_EQ(fbm.kind, NoiseTexture::Kind::fbm);
    EXPECT_EQ(fbm.octaves, 3);
    EXPECT_EQ(fbm.omega, 0.7f);
    expect_near(fbm.texture_from_world.point({2, 4, 6}), {1, 2, 3}, 1e-6f);
    EXPECT_EQ(noise("\"float\" \"wrinkled\"").octaves, 8);
    EXPECT_EQ(noise("\"float\" \"windy\"").kind, NoiseTexture::Kind::windy);
    const NoiseTexture marble =
        noise("\"spectrum\" \"marble\" \"float scale\" 3 \"float variation\" 0.4");
    EXPECT_EQ(marble.scale, 3);
    EXPECT_EQ(marble.variation, 0.4f);
    for (const char* octaves : {"-1", "65"})
        EXPECT_TRUE(contains(
            world_error(std::string("Texture \"t\" \"float\" \"fbm\" \"integer octaves\" ") +
                        octaves),
            "expected 0 to 64"));
    // Kinds of the other type are not known.
    EXPECT_TRUE(contains(world_error("Texture \"t\" \"spectrum\" \"fbm\""), "unknown"));
    EXPECT_TRUE(contains(world_error("Texture \"t\" \"float\" \"marble\""), "unknown"));
}

TEST(SceneTextures, DotsAndBilerpTakeTheirParameters) {
    const auto dots = read_world(
        "Texture \"red\" \"spectrum\" \"constant\" \"rgb value\" [ 1 0 0 ]\n"
        "Texture \"t\" \"spectrum\" \"dots\" \"texture inside\" \"red\" \"float uscale\" 4");
    const auto& d = std::get<DotsTexture>(texture(dots).value);
    EXPECT_EQ(d.mapping.scale_u, 4);
    const auto value = [&](TextureId id) {
        return std::get<ConstantTexture>(dots.textures.at(size_t(id)).value).value;
    };
    // pbrt-v4 itself shows "inside" around the dots.
    EXPECT_EQ(value(d.outside), Rgb(1, 0, 0));
    EXPECT_EQ(value(d.inside), Rgb(0));
    const auto bilerp = read_world(
        "Texture \"t\" \"spectrum\" \"bilerp\" \"rgb v01\" [ 0.1 0.2 0.3 ] \"float vscale\" 2");
    const auto& b = std::get<BilerpTexture>(texture(bilerp).value);
    EXPECT_EQ(b.mapping.scale_v, 2);
    EXPECT_EQ(b.v00, Rgb(0));
    EXPECT_EQ(b.v01, Rgb(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(b.v11, Rgb(1));
    const auto grey = read_world("Texture \"t\" \"float\" \"bilerp\" \"float v10\" 0.25");
    EXPECT_EQ(std::get<BilerpTexture>(texture(grey).value).v10, Rgb(0.25f));
}

TEST(SceneTextures, WarningsAreInFileOrder) {
    const auto scene = read_world(
        "MakeNamedMaterial \"m\" \"string type\" \"measured\" \"string filename\" \"x\"\n"
        "Shape \"sphere\" \"float x\" 1\n"
        "Texture \"t\" \"float\" \"ptex\"\n"
        "Shape \"disk\" \"float x\" 1\n");
    ASSERT_EQ(scene.warnings.size(), 4u);
    for (int i = 0; i < 4; ++i) EXPECT_EQ(scene.warnings[static_cast<size_t>(i)].where.line, i + 2);
}

TEST(SceneTextures, ErrorsNameThePlace) {
    struct Case {
        const char* text;
        const char* message;
    };
    const Case cases[] = {
        {"Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"no.png\"",
         "test.pbrt:2:35: file \"no.png\" not found"},
        {"Texture \"t\" \"spectrum\" \"imagemap\"", "has no image"},
        {"Texture \"t\" \"color\" \"constant\"", "pbrt-v3"},
        {"Texture \"t\" \"colour\" \"constant\"", "unknown texture \"colour\""},
        {"Texture \"t\" \"float\" \"marble\"", "unknown float texture \"marble\""},
        {"Texture \"t\" \"spectrum\" \"noise\"", "unknown spectrum texture \"noise\""},
        {"Texture \"t\" \"float\" \"constant\" Texture \"t\" \"float\" \"constant\"",
         "already defined at test.pbrt:2:1"},
        {"Texture \"t\" \"float\" \"scale\" \"texture tex\" \"t\"",
         "texture \"t\" refers to itself"},
        {"Texture \"a\" \"float\" \"scale\" \"texture tex\" \"b\" Texture \"b\" \"float\" "
         "\"scale\" \"texture tex\" \"a\"",
         "refers to itself"},
        {"Texture \"t\" \"float\" \"checkerboard\" \"integer dimension\" 4", "must be 2 or 3"},
        {"Texture \"t\" \"float\" \"checkerboard\" \"string mapping\" \"cubic\"",
         "unknown mapping \"cubic\""},
        {"Shape \"sphere\" \"texture alpha\" \"leaf\"",
         "test.pbrt:2:16: parameter \"alpha\" names the float texture \"leaf\""},
    };
    for (const Case& c : cases) EXPECT_TRUE(contains(world_error(c.text), c.message)) << c.text;
}

TEST(SceneTextures, EndlessChainsAreRefused) {
    std::string text;
    for (int i = 0; i < 5000; ++i)
        text += "Texture \"" + std::to_string(i) + "\" \"float\" \"scale\" \"texture tex\" \"" +
                std::to_string(i + 1) + "\"\n";
    EXPECT_TRUE(contains(world_error(text), "too long a chain"));
}

}  // namespace
}  // namespace covtrace::test
