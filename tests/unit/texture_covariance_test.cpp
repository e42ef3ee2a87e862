#include <gtest/gtest.h>

#include "core/rng.h"
#include "texture/spectra.h"
#include "texture_fixtures.h"

namespace covtrace {
namespace {

constexpr Vec3 kDpdu{1, 0, 0}, kDpdv{0, 1, 0};

/// Covariance of an edge at distance e, across itself.
float edge(float e) {
    return 1 / sqr(kPi * e);
}

SpatialCovariance2 covariance(const TextureStore& store, TextureId id, const TexturePoint& at,
                              Vec3 dpdu = kDpdu, Vec3 dpdv = kDpdv, float footprint = 1e-4f) {
    return TextureSpectra(store).uv_covariance(id, at, dpdu, dpdv, footprint);
}

CheckerboardTexture board_of(TextureId tex1, TextureId tex2, float scale_u, float scale_v) {
    CheckerboardTexture board;
    board.tex1 = tex1;
    board.tex2 = tex2;
    board.mapping.scale_u = scale_u;
    board.mapping.scale_v = scale_v;
    return board;
}

/// Waves of `cycles` periods over the image, across (1, 1) in texture coordinates.
std::filesystem::path write_waves(const TemporaryFolder& folder, const std::string& name,
                                  int cycles) {
    std::vector<float> values;
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) {
            const float s = (float(x) + 0.5f) / 64, t = 1 - (float(y) + 0.5f) / 64;
            values.push_back(0.5f + 0.3f * std::sin(2 * kPi * float(cycles) * (s + t)));
        }
    return folder.write_pfm(name, 64, 64, values);
}

TEST(TextureCovariance, IsZeroForConstants) {
    TextureScene scene;
    const TextureId grey = scene.add_constant(Rgb(0.3f));
    CheckerboardTexture board = board_of(grey, grey, 8, 8);
    const TextureId same = scene.add(board);
    TextureStore store(scene.description);
    for (const TextureId id : {grey, same}) {
        const SpatialCovariance2 c = covariance(store, id, {{0.5f, 0.5f}, {}});
        EXPECT_EQ(c.ss, 0);
        EXPECT_EQ(c.st, 0);
        EXPECT_EQ(c.tt, 0);
    }
}

TEST(TextureCovariance, OfCheckersFollowsTheDistanceToTheEdgesInUv) {
    TextureScene scene;
    const TextureId id =
        scene.add(board_of(scene.add_constant(Rgb(0.8f)), scene.add_constant(Rgb(0.2f)), 10, 4));
    TextureStore store(scene.description);
    // The place is (s, t) = (2.3, 1.9): 0.3 / 10 and 0.1 / 4 from the nearest edges.
    const SpatialCovariance2 c = covariance(store, id, {{0.23f, 0.475f}, {}});
    EXPECT_NEAR(c.ss / edge(0.03f), 1, 1e-3);
    EXPECT_NEAR(c.tt / edge(0.025f), 1, 1e-3);
    EXPECT_EQ(c.st, 0);
    // Edges are never closer than the footprint.
    const SpatialCovariance2 d = covariance(store, id, {{0.2f, 0.25f}, {}}, kDpdu, kDpdv, 0.01f);
    EXPECT_NEAR(d.ss / edge(0.01f), 1, 1e-3);
    EXPECT_NEAR(d.tt / edge(0.01f), 1, 1e-3);
    const SpatialCovariance2 on_edge = covariance(store, id, {{0.2f, 0.25f}, {}}, kDpdu, kDpdv, 0);
    EXPECT_TRUE(std::isfinite(on_edge.ss) && std::isfinite(on_edge.tt));
}

TEST(TextureCovariance, OfCheckersCountsFaintContrastLess) {
    const auto ss_for = [](Rgb a, Rgb b) {
        TextureScene scene;
        const TextureId id =
            scene.add(board_of(scene.add_constant(a), scene.add_constant(b), 1, 1));
        TextureStore store(scene.description);
        return covariance(store, id, {{0.25f, 0.5f}, {}}).ss;
    };
    EXPECT_FLOAT_EQ(ss_for(Rgb(0.9f), Rgb(0.1f)), edge(0.25f));
    EXPECT_FLOAT_EQ(ss_for(Rgb(0), Rgb(0.1f)), edge(0.25f));
    // Another hue of the same luminance is seen as well.
    EXPECT_GT(ss_for({0.5f, 0.2f, 0.1f}, {0.2f, 0.2892f, 0.1f}), 0.5f * edge(0.25f));
    const float faint = ss_for(Rgb(0.505f), Rgb(0.495f));
    EXPECT_GT(faint, 0);
    EXPECT_LT(faint, 0.11f * edge(0.25f));
}

TEST(TextureCovariance, OfSolidCheckersSeesThePlanesOnTheSurface) {
    TextureScene scene;
    CheckerboardTexture board = board_of(scene.add_float(1), scene.add_float(0), 1, 1);
    board.dimension = 3;
    board.texture_from_world = Transform::scale(2, 2, 2);
    const TextureId id = scene.add(board);
    TextureStore store(scene.description);
    // The surface is a plane z = 0.2 in the world, spanned by u along x (4 units) and v along y;
    // texture space (0.5, 1.2, 0.4): distances 0.5 and 0.2, in u 0.5 / 8, in v 0.2 / 2.
    const TexturePoint at{{}, {0.25f, 0.6f, 0.2f}};
    const SpatialCovariance2 c = covariance(store, id, at, {4, 0, 0}, {0, 1, 0});
    EXPECT_NEAR(c.ss / edge(0.5f / 8), 1, 1e-4);
    EXPECT_NEAR(c.tt / edge(0.2f / 2), 1, 1e-4);
    EXPECT_EQ(c.st, 0);
    // The planes cross both axes where v climbs through them.
    const SpatialCovariance2 tilted = covariance(store, id, at, {1, 0, 1}, {0, 1, 1});
    EXPECT_GT(tilted.st, 0);
    EXPECT_NEAR(tilted.st / edge(0.4f / 2), 1, 1e-4);
}

TEST(TextureCovariance, OfImagesHasTheDirectionOfTheFlippedImage) {
    const TemporaryFolder folder("covariance_waves");
    TextureScene scene;
    ImageTexture waves = image_texture(write_waves(folder, "waves.pfm", 4));
    const TextureId plain = scene.add(waves);
    waves.mapping.scale_u = 3;
    waves.mapping.scale_v = -2;
    const TextureId scaled = scene.add(waves);
    TextureStore store(scene.description);
    for (const float u : {0.1f, 0.37f, 0.62f}) {
        const SpatialCovariance2 c = covariance(store, plain, {{u, 0.4f}, {}});
        EXPECT_GT(c.ss, 16);
        EXPECT_LT(c.ss, 2.3f * 16);
        EXPECT_NEAR(c.tt / c.ss, 1, 0.05);
        EXPECT_GT(c.st / c.ss, 0.7);  // the values vary along (1, 1)
        // The place has equal (s, t): each u counts three of s, each v minus two of t.
        const SpatialCovariance2 s = covariance(store, scaled, {{u / 3, -0.2f}, {}});
        EXPECT_NEAR(s.ss / (9 * c.ss), 1, 1e-3);
        EXPECT_NEAR(s.st / (-6 * c.st), 1, 1e-3);
        EXPECT_NEAR(s.tt / (4 * c.tt), 1, 1e-3);
    }
}

TEST(TextureCovariance, OfPlanarMappingFollowsTheSurface) {
    const TemporaryFolder folder("covariance_planar");
    TextureScene scene;
    ImageTexture waves = image_texture(write_waves(folder, "waves.pfm", 4));
    const TextureId by_uv = scene.add(waves);
    waves.mapping.kind = TextureMapping::Kind::planar;
    waves.mapping.v1 = {0, 0, 1};
    waves.mapping.v2 = {1, 0, 0};
    const TextureId by_position = scene.add(waves);
    TextureStore store(scene.description);
    const SpatialCovariance2 c = covariance(store, by_uv, {{0.3f, 0.6f}, {}});
    // The place is s = z = 0.3 and t = x = 0.6; u moves z by 2, v moves x by 5.
    const SpatialCovariance2 p =
        covariance(store, by_position, {{0.9f, 0.1f}, {0.6f, 8, 0.3f}}, {0, 1, 2}, {5, 0, 0});
    EXPECT_NEAR(p.ss / (4 * c.ss), 1, 1e-3);
    EXPECT_NEAR(p.st / (10 * c.st), 1, 1e-3);
    EXPECT_NEAR(p.tt / (25 * c.tt), 1, 1e-3);
}

TEST(TextureCovariance, OfAnInvertedImageUsesTheContrastThatIsSeen) {
    const TemporaryFolder folder("covariance_invert");
    std::vector<float> values;  // bright, so that its negative is dark and has a high contrast
    for (int i = 0; i < 64 * 64; ++i)
        values.push_back(0.94f + 0.05f * std::sin(2 * kPi * float(i % 64) / 8));
    TextureScene scene;
    ImageTexture texture = image_texture(folder.write_pfm("bright.pfm", 64, 64, values));
    const TextureId bright = scene.add(texture);
    texture.invert = true;
    const TextureId dark = scene.add(texture);
    TextureStore store(scene.description);
    EXPECT_GT(covariance(store, dark, {{0.5f, 0.5f}, {}}).ss,
              3 * covariance(store, bright, {{0.5f, 0.5f}, {}}).ss);
}

TEST(TextureCovariance, OfBlackSurroundingsSeesTheBorder) {
    const TemporaryFolder folder("covariance_border");
    TextureScene scene;
    ImageTexture texture =
        image_texture(folder.write_pfm("flat.pfm", 8, 8, std::vector<float>(64, 0.5f)));
    texture.wrap = ImageTexture::Wrap::black;
    const TextureId id = scene.add(texture);
    TextureStore store(scene.description);
    for (const float u : {0.1f, 0.9f, -0.1f, 1.1f}) {
        const SpatialCovariance2 c = covariance(store, id, {{u, 0.5f}, {}});
        EXPECT_NEAR(c.ss / edge(0.1f), 1, 1e-3);
        EXPECT_NEAR(c.tt / edge(0.5f), 1, 1e-3);
    }
    texture.wrap = {ImageTexture::Wrap::repeat, ImageTexture::Wrap::black};
    const TextureId band = scene.add(texture);
    TextureStore more(scene.description);
    const SpatialCovariance2 c = covariance(more, band, {{0.1f, 0.5f}, {}});
    EXPECT_EQ(c.ss, 0);
    EXPECT_NEAR(c.tt / edge(0.5f), 1, 1e-3);
}

TEST(TextureCovariance, OfAnImageMirroredInOneAxisIsMirroredThere) {
    const TemporaryFolder folder("covariance_mirror");
    TextureScene scene;
    ImageTexture texture = image_texture(write_waves(folder, "waves.pfm", 6));
    const auto with = [&](ImageTexture::Wraps wraps) {
        texture.wrap = wraps;
        return scene.add(texture);
    };
    const auto mirror = ImageTexture::Wrap::mirror, repeat = ImageTexture::Wrap::repeat;
    const TextureId in_s = with({mirror, repeat}), in_t = with({repeat, mirror});
    TextureStore store(scene.description);
    const SpatialCovariance2 here = covariance(store, in_s, {{0.3f, 0.55f}, {}});
    EXPECT_GT(here.st, 0.5f * here.ss);
    const auto expect_turned = [&](TextureId id, Vec2 uv, float sign) {
        const SpatialCovariance2 c = covariance(store, id, {uv, {}});
        EXPECT_NEAR(c.ss / here.ss, 1, 0.1f);
        EXPECT_NEAR(c.tt / here.tt, 1, 0.1f);
        EXPECT_NEAR(c.st / here.st, sign, 0.1f);
    };
    expect_turned(in_s, {1.7f, 0.55f}, -1);
    expect_turned(in_s, {0.3f, 1.55f}, 1);
    expect_turned(in_t, {1.3f, 0.55f}, 1);
    expect_turned(in_t, {0.3f, 1.45f}, -1);
}

TEST(TextureCovariance, OfProductsAddsAndOfMixturesWeighs) {
    const TemporaryFolder folder("covariance_graph");
    TextureScene scene;
    const TextureId slow = scene.add(image_texture(write_waves(folder, "slow.pfm", 2)));
    const TextureId fast = scene.add(image_texture(write_waves(folder, "fast.pfm", 8)));
    const TextureId product = scene.add(ScaleTexture{slow, fast});
    const TextureId dimmed = scene.add(ScaleTexture{slow, scene.add_float(0.1f)});
    const TextureId mostly_slow = scene.add(MixTexture{slow, fast, scene.add_float(0.1f)});
    const TextureId even = scene.add(MixTexture{slow, fast, scene.add_float(0.5f)});
    const TextureId masked =
        scene.add(MixTexture{scene.add_float(0.2f), scene.add_float(0.7f), fast});
    TextureStore store(scene.description);
    const TexturePoint at{{0.3f, 0.55f}, {}};
    const auto ss = [&](TextureId id) { return covariance(store, id, at).ss; };
    EXPECT_FLOAT_EQ(ss(product), ss(slow) + ss(fast));
    EXPECT_FLOAT_EQ(ss(dimmed), ss(slow));
    EXPECT_GT(ss(mostly_slow), ss(slow));
    EXPECT_LT(ss(mostly_slow), ss(even));
    EXPECT_LT(ss(even), ss(fast));
    EXPECT_FLOAT_EQ(ss(masked), ss(fast));
}

TEST(TextureCovariance, OfACheckerboardIncludesTheActiveSquare) {
    const TemporaryFolder folder("covariance_squares");
    TextureScene scene;
    const TextureId waves = scene.add(image_texture(write_waves(folder, "waves.pfm", 8)));
    const TextureId id = scene.add(board_of(waves, scene.add_constant(Rgb(3)), 4, 4));
    TextureStore store(scene.description);
    const TexturePoint on_waves{{0.125f, 0.125f}, {}}, on_constant{{0.375f, 0.125f}, {}};
    EXPECT_NEAR(covariance(store, id, on_constant).ss / edge(0.125f), 1, 1e-3);
    EXPECT_NEAR(
        covariance(store, id, on_waves).ss / (edge(0.125f) + covariance(store, waves, on_waves).ss),
        1, 1e-3);
}

TEST(TextureSpectra, AreMadeOncePerImageAndKeptBesideTheTextures) {
    const TemporaryFolder folder("covariance_shared");
    const ImageTexture waves = image_texture(write_waves(folder, "waves.pfm", 8));
    ImageTexture scaled = waves, inverted = waves;
    scaled.scale = 3;  // the analysis is relative to the mean
    inverted.invert = true;
    // Bytes after a look at each texture, which makes its part of the analysis.
    const auto bytes_of = [](const std::vector<ImageTexture>& images, TextureBandwidth bandwidth) {
        TextureScene scene;
        for (const ImageTexture& image : images) scene.add(image);
        const TextureStore store(scene.description);
        const size_t of_textures = store.memory();
        const TextureSpectra spectra(store, bandwidth);
        for (TextureId id = 0; id < TextureId(images.size()); ++id)
            spectra.uv_covariance(id, {{0.4f, 0.6f}, {}}, kDpdu, kDpdv, 1e-4f);
        EXPECT_EQ(store.memory(), of_textures);
        return spectra.memory();
    };
    const size_t one = bytes_of({waves}, TextureBandwidth::own);
    EXPECT_GT(one, 64 * 64 * sizeof(float));
    EXPECT_EQ(bytes_of({waves, scaled}, TextureBandwidth::own), one);
    EXPECT_EQ(bytes_of({waves, inverted}, TextureBandwidth::own), 2 * one);
    EXPECT_EQ(bytes_of({waves}, TextureBandwidth::highest), 0u);
}

}  // namespace
}  // namespace covtrace
