// The bound on the memory of texture images: which images shrink, and that shrinking keeps means.
#include <gtest/gtest.h>

#include "core/parallel.h"
#include "core/rng.h"
#include "image/color_encoding.h"
#include "shading/texture.h"
#include "shading/texture_image.h"
#include "texture_fixtures.h"

namespace covtrace {
namespace {

RasterImage raster_of(int width, int height, int channels, bool is_8bit) {
    RasterImage r;
    r.width = width;
    r.height = height;
    r.channels = channels;
    r.is_8bit = is_8bit;
    Rng rng(3);
    for (int i = 0; i < width * height * channels; ++i) {
        const float v = rng.next_float();
        r.values.push_back(is_8bit ? std::floor(v * 255) / 255 : v);
    }
    return r;
}

Rgb mean_of(const TextureImage& image) {
    Rgb sum;
    const size_t n = size_t(image.width()) * size_t(image.height());
    for (size_t i = 0; i < n; ++i) sum += image.color(i) * (1.0f / float(n));
    return sum;
}

TEST(TextureMemory, HalvingKeepsTheMeanOfDecodedValues) {
    for (const bool is_8bit : {true, false})
        for (const auto encoding : {ImageTexture::Encoding::srgb, ImageTexture::Encoding::linear}) {
            TextureImage image(raster_of(64, 32, 3, is_8bit), encoding, 1,
                               ImageTexture::Wrap::repeat);
            const Rgb before = mean_of(image);
            const size_t bytes = image.memory();
            image.halve();
            EXPECT_EQ(image.width(), 32);
            EXPECT_EQ(image.height(), 16);
            EXPECT_EQ(image.memory(), bytes / 4);
            // 8-bit values are rounded to one of 255 steps; the mean over 512 texels to less.
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(mean_of(image)[c], before[c], is_8bit ? 5e-4 : 1e-6);
        }
}

TEST(TextureMemory, HalvingTakesMeansOfFourTexels) {
    RasterImage r = raster_of(3, 3, 1, false);
    TextureImage image(r, ImageTexture::Encoding::linear, 1, ImageTexture::Wrap::clamp);
    image.halve();
    ASSERT_EQ(image.width(), 2);
    const auto& v = r.values;
    EXPECT_FLOAT_EQ(image.value(0), (v[0] + v[1] + v[3] + v[4]) / 4);
    EXPECT_FLOAT_EQ(image.value(1), (v[2] + v[5]) / 2);
    EXPECT_FLOAT_EQ(image.value(2), (v[6] + v[7]) / 2);
    EXPECT_FLOAT_EQ(image.value(3), v[8]);
    image.halve();
    image.halve();
    EXPECT_EQ(image.memory(), sizeof(float));
}

TEST(TextureMemory, EightBitColoursThatAreConstantStayExact) {
    for (int byte = 0; byte < 256; ++byte) {
        RasterImage r = raster_of(2, 2, 1, true);
        r.values.assign(4, float(byte) / 255);
        TextureImage image(r, ImageTexture::Encoding::srgb, 1, ImageTexture::Wrap::repeat);
        const float before = image.value(size_t{0});
        image.halve();
        EXPECT_EQ(image.value(size_t{0}), before) << byte;
    }
}

/// Bytes that the images take under a limit; checks the number of warnings.
size_t bytes_within(const SceneDescription& scene, size_t limit, size_t warnings) {
    const TextureStore store(scene, limit);
    EXPECT_EQ(store.warnings().size(), warnings) << "limit " << limit;
    return store.memory();
}

TEST(TextureMemory, TheLargestImagesShrinkUntilAllFit) {
    const TemporaryFolder folder("texture_memory");
    TextureScene scene;
    for (int size : {8, 64, 16, 32, 64, 8, 8, 8, 8, 8, 64}) {
        const std::string name = "image" + std::to_string(scene.description.textures.size());
        scene.add(image_texture(folder.write_ppm(
            name + ".ppm", size, size, std::vector<uint8_t>(size_t(size * size * 3), 120))));
    }
    const auto levels = [](size_t size) {
        size_t texels = 0;
        for (; size > 0; size /= 2) texels += size * size;
        return 3 * texels;
    };
    const size_t all = 3 * levels(64) + levels(32) + levels(16) + 6 * levels(8);
    const size_t finest = 3 * 64 * 64;  // bytes that one of the largest loses
    const auto& d = scene.description;
    EXPECT_EQ(bytes_within(d, kNoTextureLimit, 0), all);
    EXPECT_EQ(bytes_within(d, all, 0), all);
    // One of the three largest is enough; then two; then all three.
    EXPECT_EQ(bytes_within(d, all - 1, 1), all - finest);
    EXPECT_EQ(bytes_within(d, all - finest - 1, 2), all - 2 * finest);
    EXPECT_EQ(bytes_within(d, all - 3 * finest, 3), all - 3 * finest);
    // Below a texel each nothing more can go.
    EXPECT_EQ(bytes_within(d, 1, 11), size_t(11 * 3));
    EXPECT_EQ(bytes_within(d, 1000, 11), [&] {
        const ThreadLimit one(1);
        return TextureStore(d, 1000).memory();
    }());
}

}  // namespace
}  // namespace covtrace
