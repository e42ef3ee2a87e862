// Image textures as glTF needs them: channels, cutoffs, mirrored wrapping, rotation, embedded
// files.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "bsdf/coat_table.h"
#include "core/warp.h"
#include "texture/image.h"
#include "texture/texture.h"

namespace covtrace::test {
namespace {

using Channel = ImageTexture::Channel;

/// Two texels side by side: (0.2, 0.4, 0.6, 1) and (1, 0, 0.8, 0.5), 8 bits.
TextureImage pair(ImageTexture::Wrap wrap) {
    RasterImage raster{.width = 2,
                       .height = 1,
                       .channels = 4,
                       .bytes = {51, 102, 153, 255, 255, 0, 204, 128},
                       .values = {},
                       .is_8bit = true};
    return {raster, ImageTexture::Encoding::linear, 1, wrap};
}

TEST(TextureChannels, AreRead) {
    const TextureImage image = pair(ImageTexture::Wrap::repeat);
    constexpr float kStep = 1.0f / 255;
    EXPECT_NEAR(image.value(0, Channel::red), 0.2f, kStep);
    EXPECT_NEAR(image.value(0, Channel::green), 0.4f, kStep);
    EXPECT_NEAR(image.value(1, Channel::blue), 0.8f, kStep);
    EXPECT_NEAR(image.value(1, Channel::alpha), 0.5f, kStep);
    EXPECT_NEAR(image.value(1), 0.5f, kStep);  // alpha, as pbrt has it
    RasterImage grey{
        .width = 1, .height = 1, .channels = 1, .bytes = {}, .values = {0.25f}, .is_8bit = false};
    const TextureImage one(grey, ImageTexture::Encoding::linear, 1, ImageTexture::Wrap::repeat);
    EXPECT_EQ(one.value(0, Channel::blue), 0.25f);
    EXPECT_EQ(one.value(0, Channel::alpha), 1);
}

TEST(TextureChannels, MirrorBackAndForth) {
    EXPECT_FLOAT_EQ(mirrored(0.25f), 0.25f);
    EXPECT_FLOAT_EQ(mirrored(1.25f), 0.75f);
    EXPECT_FLOAT_EQ(mirrored(-0.25f), 0.25f);
    EXPECT_FLOAT_EQ(mirrored(2.25f), 0.25f);
    EXPECT_GE(mirrored(std::nanf("")), 0);
    const TextureImage image = pair(ImageTexture::Wrap::mirror);
    EXPECT_EQ(image.nearest({1.25f, 0.5f}).texel[0], 1u);
    EXPECT_EQ(image.nearest({1.75f, 0.5f}).texel[0], 0u);
}

/// A PGM of 2 x 2 texels, from the top: 0, 255 / 51, 204.
const std::string kGrey("P5\n2 2\n255\n\x00\xff\x33\xcc", 15);

SceneDescription scene_of(ImageTexture texture) {
    texture.content = std::make_shared<const std::string>(kGrey);
    texture.file = "images[0]";
    texture.encoding = ImageTexture::Encoding::linear;
    texture.filter = ImageTexture::Filter::point;
    SceneDescription scene;
    scene.textures.push_back({{}, false, texture, {}});
    return scene;
}

TEST(TextureChannels, ReadEmbeddedFiles) {
    const TextureStore textures(scene_of({}));
    EXPECT_NEAR(textures.eval_float(0, {{0.25f, 0.25f}, {}}), 0.2f, 1e-6f);  // lower left
    EXPECT_NEAR(textures.eval_float(0, {{0.75f, 0.75f}, {}}), 1, 1e-6f);
    SceneDescription broken = scene_of({});
    std::get<ImageTexture>(broken.textures[0].value).content =
        std::make_shared<const std::string>("no image");
    EXPECT_THROW(TextureStore{broken}, Error);
}

TEST(TextureChannels, CutAtAValue) {
    ImageTexture t;
    t.cutoff = 0.5f;
    const TextureStore textures(scene_of(t));
    EXPECT_EQ(textures.eval_float(0, {{0.25f, 0.25f}, {}}), 0);
    EXPECT_EQ(textures.eval_float(0, {{0.75f, 0.25f}, {}}), 1);
    EXPECT_EQ(textures.mean(0).r, 0.5f);
}

TEST(TextureChannels, TurnByTheMapping) {
    ImageTexture t;
    // The map is (s, t) = (v, 1 - u): a quarter turn.
    t.mapping.scale_u = t.mapping.scale_v = 0;
    t.mapping.u_per_v = 1;
    t.mapping.v_per_u = -1;
    t.mapping.delta_v = 1;
    const TextureStore textures(scene_of(t));
    // The place (0.25, 0.75) shows (0.75, 0.75): the upper right texel.
    EXPECT_NEAR(textures.eval_float(0, {{0.25f, 0.75f}, {}}), 1, 1e-6f);
    EXPECT_NEAR(textures.eval_float(0, {{0.25f, 0.25f}, {}}), 0, 1e-6f);
}

/// Directional albedo by midpoints over the square of cosine-weighted directions, plus the
/// specular part of a smooth coat.
float albedo_of(const CoatedDiffuseBsdf& b, float cos_o) {
    const Bsdf bsdf = b;
    const Vec3 wo{std::sqrt(1 - cos_o * cos_o), 0, cos_o};
    double sum = 0;
    constexpr int kSide = 400;
    for (int i = 0; i < kSide; ++i)
        for (int j = 0; j < kSide; ++j) {
            const Vec2 u{(float(i) + 0.5f) / kSide, (float(j) + 0.5f) / kSide};
            const Vec3 wi = square_to_cosine_hemisphere(u);
            if (wi.z > 0) sum += luminance(eval(bsdf, wo, wi)) / cosine_hemisphere_pdf(wi.z);
        }
    return float(sum / (kSide * kSide));
}

TEST(CoatedTotal, WhiteReflectsAllLightOfRoughCoats) {
    for (const float eta : {1.5f, 1000.0f}) {
        const CoatTable table(eta, 0);
        for (const float alpha : {0.2f, 0.5f, 1.0f})
            for (const float cos_o : {0.3f, 0.7f, 1.0f})
                EXPECT_NEAR(albedo_of(make_coated_total(table, Rgb(1), alpha, alpha), cos_o), 1,
                            0.01f)
                    << "eta " << eta << ", alpha " << alpha << ", cos " << cos_o;
    }
}

TEST(CoatedTotal, IsTheLayeredBodyUnderASmoothCoat) {
    const CoatTable table(1.5f, 0);
    const float r = 0.4f, inside = table.internal_reflectance(0);
    const Bsdf total = make_coated_total(table, Rgb(r), 0, 0);
    const Bsdf layered = make_coated_diffuse(
        table, reflectance_powers(Rgb(r / (1 - inside + inside * r))), 0, 0, 200);
    const Vec3 wo = normalize(Vec3{0.3f, 0.2f, 0.8f}), wi = normalize(Vec3{-0.5f, 0.4f, 0.5f});
    EXPECT_NEAR(eval(total, wo, wi).g / eval(layered, wo, wi).g, 1, 0.005f);
}

TEST(CoatedTotal, IsReciprocal) {
    const CoatTable table(1.5f, 0);
    const Bsdf b = make_coated_total(table, Rgb(0.7f), 0.3f, 0.3f);
    const Vec3 wo = normalize(Vec3{0.9f, 0.1f, 0.3f}), wi = normalize(Vec3{-0.2f, 0.4f, 0.9f});
    EXPECT_NEAR(eval(b, wo, wi).r / wi.z, eval(b, wi, wo).r / wo.z, 1e-5f);
}

}  // namespace
}  // namespace covtrace::test
