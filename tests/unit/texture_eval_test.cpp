#include <gtest/gtest.h>

#include "core/parallel.h"
#include "image/color_encoding.h"
#include "texture/texture.h"
#include "texture_fixtures.h"

namespace covtrace {
namespace {

constexpr TexturePoint kCentre{{0.5f, 0.5f}, {0, 0, 0}};

void expect_near(Rgb a, Rgb b) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 1e-5);
}

TEST(TextureStore, ScalesAndMixesAtAnyDepth) {
    TextureScene scene;
    const TextureId red = scene.add_constant({0.8f, 0.1f, 0.1f});
    const TextureId blue = scene.add_constant({0.1f, 0.2f, 0.9f});
    CheckerboardTexture board;
    board.tex1 = red;
    board.tex2 = blue;
    const TextureId checks = scene.add(board);
    const TextureId mixed = scene.add(MixTexture{red, checks, scene.add_float(0.25f)});
    TextureId scaled = mixed;
    for (int i = 0; i < 5; ++i) scaled = scene.add(ScaleTexture{scaled, scene.add_float(0.5f)});
    const TextureStore store(scene.description);
    const TexturePoint on_red{{0.5f, 0.5f}, {}}, on_blue{{1.5f, 0.5f}, {}};
    expect_near(store.eval(scaled, on_red), Rgb(0.8f, 0.1f, 0.1f) * (1.0f / 32));
    expect_near(store.eval(scaled, on_blue),
                (Rgb(0.8f, 0.1f, 0.1f) * 0.75f + Rgb(0.1f, 0.2f, 0.9f) * 0.25f) * (1.0f / 32));
}

TEST(TextureStore, MixesByTheNormal) {
    // The texture is pbrt-v4's directionmix: tex1 where the normal is along the direction, either
    // way.
    TextureScene scene;
    const TextureId aside = scene.add(AsideTexture{{0, 0.6f, 0.8f}});
    const TextureId mixed = scene.add(MixTexture{scene.add_float(2), scene.add_float(4), aside});
    const TextureStore store(scene.description);
    const auto value = [&](Vec3 normal) { return store.eval_float(mixed, {{}, {}, {}, normal}); };
    EXPECT_FLOAT_EQ(value({0, 0.6f, 0.8f}), 2);
    EXPECT_FLOAT_EQ(value({0, -0.6f, -0.8f}), 2);
    EXPECT_FLOAT_EQ(value({1, 0, 0}), 4);
    EXPECT_FLOAT_EQ(value({0, 0, -1}), 0.8f * 2 + 0.2f * 4);
    EXPECT_FLOAT_EQ(value({}), 3);  // an unknown normal gives half of each
}

TEST(TextureStore, KnowsWhatIsConstant) {
    TextureScene scene;
    const TextureId half = scene.add_float(0.5f), zero = scene.add_float(0),
                    one = scene.add_float(1);
    CheckerboardTexture board;
    board.tex1 = zero;
    board.tex2 = one;
    const TextureId checks = scene.add(board);
    board.tex2 = scene.add_float(0);
    const TextureId same = scene.add(board);
    const TextureId product = scene.add(ScaleTexture{half, half});
    const TextureId nothing = scene.add(ScaleTexture{checks, zero});
    const TextureId kept = scene.add(ScaleTexture{checks, one});
    const TextureId first = scene.add(MixTexture{half, checks, zero});
    const TextureId second = scene.add(MixTexture{half, checks, one});
    const TextureId mean = scene.add(MixTexture{half, one, half});
    const TextureStore store(scene.description);
    for (const TextureId id : {half, same, product, nothing, first, mean})
        EXPECT_TRUE(store.is_constant(id)) << id;
    for (const TextureId id : {checks, kept, second}) EXPECT_FALSE(store.is_constant(id)) << id;
    EXPECT_FLOAT_EQ(store.eval_float(product, kCentre), 0.25f);
    EXPECT_FLOAT_EQ(store.eval_float(nothing, kCentre), 0);
    EXPECT_FLOAT_EQ(store.eval_float(first, kCentre), 0.5f);
    EXPECT_FLOAT_EQ(store.eval_float(mean, kCentre), 0.75f);
    EXPECT_FLOAT_EQ(store.eval_float(second, {{1.5f, 0.5f}, {}}), 1);
}

TEST(TextureStore, RefersToLaterTexturesToo) {
    TextureScene scene;
    const TextureId scaled = scene.add(ScaleTexture{1, 2}, false);
    scene.add_float(3);
    scene.add_float(4);
    EXPECT_FLOAT_EQ(TextureStore(scene.description).eval_float(scaled, kCentre), 12);
}

TEST(TextureStore, RefusesToNestWithoutEnd) {
    TextureScene scene;
    CheckerboardTexture board;
    board.tex2 = scene.add_float(1);
    board.tex1 = scene.add_float(0);
    TextureId deepest = -1;
    for (int i = 0; i < 2000; ++i) {
        // Children after their parents, so that building starts at the top.
        board.tex1 = TextureId(scene.description.textures.size()) + 1;
        deepest = scene.add(board);
    }
    scene.add_float(0);
    EXPECT_GT(deepest, 0);
    try {
        const TextureStore store(scene.description);
        FAIL() << "expected an error";
    } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::limit);
    }
}

TEST(TextureStore, ChecksTheCellsOfAllSigns) {
    TextureScene scene;
    CheckerboardTexture board;
    board.tex1 = scene.add_float(1);
    board.tex2 = scene.add_float(0);
    board.mapping.scale_u = 2;
    board.mapping.scale_v = 4;
    board.mapping.delta_u = 1;
    const TextureId flat = scene.add(board, false);
    CheckerboardTexture solid;
    solid.dimension = 3;
    solid.tex1 = board.tex1;
    solid.tex2 = board.tex2;
    solid.texture_from_world = Transform::scale(10, 10, 10);
    const TextureId cubes = scene.add(solid, false);
    const TextureStore store(scene.description);
    const auto at_uv = [&](float u, float v) { return store.eval_float(flat, {{u, v}, {}}); };
    EXPECT_EQ(at_uv(0.25f, 0.1f), 0);    // cell (1, 0)
    EXPECT_EQ(at_uv(0.25f, 0.3f), 1);    // (1, 1)
    EXPECT_EQ(at_uv(-0.25f, 0.1f), 1);   // (0, 0)
    EXPECT_EQ(at_uv(-0.75f, 0.1f), 0);   // (-1, 0)
    EXPECT_EQ(at_uv(-0.75f, -0.1f), 1);  // (-1, -1)
    const auto at_point = [&](Vec3 p) { return store.eval_float(cubes, {{}, p}); };
    EXPECT_EQ(at_point({0.05f, 0.05f, 0.05f}), 1);
    EXPECT_EQ(at_point({0.15f, 0.05f, 0.05f}), 0);
    EXPECT_EQ(at_point({0.15f, -0.05f, 0.05f}), 1);
    EXPECT_EQ(at_point({-0.15f, -0.05f, -0.05f}), 1);
    EXPECT_EQ(at_point({-0.05f, -0.05f, -0.05f}), 0);
}

TEST(TextureStore, ReadsImagesFromTheBottomUp) {
    const TemporaryFolder folder("texture_flip");
    TextureScene scene;
    // Red, green / blue, white.
    const auto file =
        folder.write_ppm("four.ppm", 2, 2, {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255});
    ImageTexture texture = image_texture(file);
    texture.filter = ImageTexture::Filter::point;
    const TextureId id = scene.add(texture);
    const TextureStore store(scene.description);
    expect_near(store.eval(id, {{0.25f, 0.25f}, {}}), {0, 0, 1});
    expect_near(store.eval(id, {{0.75f, 0.25f}, {}}), {1, 1, 1});
    expect_near(store.eval(id, {{0.25f, 0.75f}, {}}), {1, 0, 0});
    expect_near(store.eval(id, {{1.75f, -0.25f}, {}}), {0, 1, 0});
}

TEST(TextureStore, DecodesScalesAndInverts) {
    const TemporaryFolder folder("texture_decode");
    const auto bytes = folder.write_ppm("grey.ppm", 1, 1, {64, 128, 192});
    const auto floats = folder.write_pfm("grey.pfm", 1, 1, {2.5f});
    const Rgb encoded(64.0f / 255, 128.0f / 255, 192.0f / 255);
    const Rgb decoded(srgb_decode(encoded.r), srgb_decode(encoded.g), srgb_decode(encoded.b));
    TextureScene scene;
    ImageTexture t = image_texture(bytes);
    const TextureId plain = scene.add(t);
    const TextureId as_float = scene.add(t, false);
    t.encoding = ImageTexture::Encoding::linear;
    const TextureId linear = scene.add(t);
    t.encoding = ImageTexture::Encoding::gamma;
    t.gamma = 2;
    t.scale = 0.5f;
    t.invert = true;
    const TextureId inverted = scene.add(t);
    t.scale = 100;
    const TextureId negative = scene.add(t);
    ImageTexture f = image_texture(floats);
    f.encoding = ImageTexture::Encoding::srgb;  // has no meaning for floats
    f.scale = 2;
    const TextureId wide = scene.add(f);
    const TextureStore store(scene.description);
    expect_near(store.eval(plain, kCentre), decoded);
    EXPECT_NEAR(store.eval_float(as_float, kCentre), (decoded.r + decoded.g + decoded.b) / 3, 1e-5);
    EXPECT_EQ(store.eval(as_float, kCentre), Rgb(store.eval_float(as_float, kCentre)));
    expect_near(store.eval(linear, kCentre), encoded);
    expect_near(store.eval(inverted, kCentre), Rgb(1) - encoded * encoded * 0.5f);
    expect_near(store.eval(negative, kCentre), Rgb(0));
    expect_near(store.eval(wide, kCentre), Rgb(5));
}

TEST(TextureStore, SharesEqualImages) {
    const TemporaryFolder folder("texture_share");
    const auto file =
        folder.write_ppm("a.ppm", 16, 16, std::vector<uint8_t>(size_t(3 * 16 * 16), 100));
    const auto memory_of = [&](const std::vector<ImageTexture>& textures) {
        TextureScene scene;
        for (const ImageTexture& t : textures) scene.add(t);
        return TextureStore(scene.description).memory();
    };
    ImageTexture one = image_texture(file), scaled = one, roundabout = one, clamped = one;
    scaled.scale = 3;
    scaled.filter = ImageTexture::Filter::point;
    roundabout.file = file.parent_path() / "." / file.filename();
    clamped.wrap = ImageTexture::Wrap::clamp;
    EXPECT_EQ(memory_of({one}), size_t(3 * (16 * 16 + 8 * 8 + 4 * 4 + 2 * 2 + 1)));
    EXPECT_EQ(memory_of({one, scaled, roundabout}), memory_of({one}));
    EXPECT_EQ(memory_of({one, clamped}), 2 * memory_of({one}));
}

TEST(TextureStore, NamesTheFirstMissingFileForAnyNumberOfThreads) {
    TextureScene scene;
    for (const char* name : {"no_such_a.png", "no_such_b.png", "no_such_c.png"})
        scene.add(image_texture(name));
    scene.description.textures[0].where = {std::make_shared<const std::string>("scene.pbrt"), 7, 3};
    for (const int threads : {1, 4}) {
        const ThreadLimit limit(threads);
        try {
            const TextureStore store(scene.description);
            FAIL() << "expected an error";
        } catch (const Error& e) {
            EXPECT_EQ(e.kind(), ErrorKind::scene);
            EXPECT_NE(std::string(e.what()).find("scene.pbrt:7:3"), std::string::npos) << e.what();
            EXPECT_NE(std::string(e.what()).find("no_such_a.png"), std::string::npos) << e.what();
        }
    }
}

TEST(TextureEval, TexturesThatDoubleWithEveryLevelAreRefused) {
    const TemporaryFolder folder("doubling");
    TextureScene scene;
    TextureId id = scene.add(image_texture(folder.write_ppm("a.ppm", 1, 1, {200, 200, 200})));
    for (int i = 0; i < 40; ++i) id = scene.add(ScaleTexture{id, id});
    try {
        const TextureStore store(scene.description);
        FAIL() << "accepted";
    } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::limit);
    }
}

}  // namespace
}  // namespace covtrace
