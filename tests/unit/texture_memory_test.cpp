// The bound on the memory of texture images: the place of the texels, and that values don't depend
// on it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "core/parallel.h"
#include "core/rng.h"
#include "texture/image.h"
#include "texture/texel_pages.h"
#include "texture/texture.h"
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
        add_value(r, is_8bit ? std::floor(v * 255) / 255 : v);
    }
    return r;
}

/// Places inside, outside and at the borders of an image, with footprints of all sizes.
struct Lookup {
    Vec2 st;
    ImageFootprint footprint;
};
std::vector<Lookup> lookups() {
    std::vector<Lookup> all;
    Rng rng(5);
    for (int i = 0; i < 300; ++i) {
        const auto number = [&](float size) { return size * (2 * rng.next_float() - 1); };
        const float size = std::exp2(-12 * rng.next_float());
        all.push_back(
            {{number(2), number(2)}, {{number(size), number(size)}, {number(size), number(size)}}});
    }
    return all;
}

/// The values of all lookups, with every filter.
std::vector<float> values_of(const TextureImage& image) {
    using Filter = TextureImage::Filter;
    using Channel = TextureImage::Channel;
    std::vector<float> values;
    for (const auto& [st, footprint] : lookups()) {
        for (const Filter filter :
             {Filter::point, Filter::bilinear, Filter::trilinear, Filter::ewa}) {
            const Rgb c = image.color(st, filter, footprint, 8);
            values.insert(values.end(), {c.r, c.g, c.b});
        }
        for (const Channel channel :
             {Channel::automatic, Channel::red, Channel::green, Channel::blue, Channel::alpha})
            values.push_back(image.value(st, Filter::bilinear, footprint, 8, channel));
    }
    return values;
}

TEST(TextureMemory, CoarserLevelsAreMeansOfFourTexels) {
    const RasterImage r = raster_of(3, 3, 1, false);
    TextureImage image(r, ImageTexture::Encoding::linear, 1, ImageTexture::Wrap::clamp);
    image.build_levels();
    ASSERT_EQ(image.level_count(), 3u);
    const auto& v = r.values;
    const std::array<float, 4> means{(v[0] + v[1] + v[3] + v[4]) / 4, (v[2] + v[5]) / 2,
                                     (v[6] + v[7]) / 2, v[8]};
    const std::array<Vec2, 4> places{{{0.1f, 0.1f}, {0.9f, 0.1f}, {0.1f, 0.9f}, {0.9f, 0.9f}}};
    for (size_t i = 0; i < 4; ++i)
        EXPECT_FLOAT_EQ(image.value(image.nearest(places[i], 1)), means[i]);
    EXPECT_EQ(image.memory(), (9 + 4 + 1) * sizeof(float));
}

TEST(TextureMemory, EightBitColoursThatAreConstantStayExactAtAllLevels) {
    for (int byte = 0; byte < 256; ++byte) {
        RasterImage r = raster_of(4, 2, 1, true);
        r.bytes.assign(8, uint8_t(byte));
        TextureImage image(r, ImageTexture::Encoding::srgb, 1, ImageTexture::Wrap::repeat);
        image.build_levels();
        for (size_t level = 1; level < image.level_count(); ++level)
            EXPECT_EQ(image.value(image.nearest({}, level)), image.value(size_t{0})) << byte;
    }
}

TEST(TextureMemory, LookupsDoNotDependOnWhereLevelsLie) {
    using Wrap = ImageTexture::Wrap;
    // The images are larger than a tile in neither, one and both directions, whole numbers of tiles
    // and not.
    const std::array<std::array<int, 2>, 4> sizes{{{5, 7}, {300, 3}, {129, 200}, {256, 128}}};
    for (const auto& [width, height] : sizes)
        for (const int channels : {1, 3, 4})
            for (const bool is_8bit : {true, false}) {
                SCOPED_TRACE(testing::Message() << width << "x" << height << ", " << channels
                                                << " channels of " << (is_8bit ? 1 : 4));
                const auto wrap = width == 256  ? Wrap::octahedral_sphere
                                  : width == 5  ? Wrap::black
                                  : width > 200 ? Wrap::mirror
                                                : Wrap::repeat;
                TextureImage image(raster_of(width, height, channels, is_8bit),
                                   ImageTexture::Encoding::srgb, 1, wrap);
                image.build_levels();
                const std::vector<float> whole = values_of(image);
                const auto pages = std::make_shared<TexelPages>(4 * TexelPages::kPageBytes);
                while (const size_t bytes = image.finest_in_memory()) {
                    const size_t before = image.memory();
                    image.move_finest_to(pages);
                    EXPECT_EQ(image.memory(), before - bytes);
                }
                EXPECT_EQ(image.memory(), 0u);
                EXPECT_TRUE(image.is_paged());
                EXPECT_EQ(values_of(image), whole);
                std::vector<char> equal(16);
                parallel_for(int64_t(equal.size()),
                             [&](int64_t i) { equal[size_t(i)] = values_of(image) == whole; });
                EXPECT_EQ(std::count(equal.begin(), equal.end(), 1), 16) << "from many threads";
            }
}

TEST(TexelPages, GiveBackWhatWasAdded) {
    // Pages in memory are one at least, however little is allowed; whole sets of eight where there
    // is room.
    EXPECT_EQ(TexelPages(0).memory(), TexelPages::kPageBytes);
    EXPECT_EQ(TexelPages(size_t(1) << 20).memory(), size_t(1) << 20);
    EXPECT_LE(TexelPages(12345678).memory(), 12345678u);
    TexelPages pages(3 * TexelPages::kPageBytes);
    constexpr size_t kCount = 50;
    for (size_t p = 0; p < kCount; ++p) {
        const std::vector<std::byte> page(p + 1 == kCount ? 7 : TexelPages::kPageBytes,
                                          std::byte(p + 1));
        EXPECT_EQ(pages.add(page), p);
    }
    Rng rng(1);
    for (int i = 0; i < 5000; ++i) {
        const size_t p = size_t(rng.next_float() * kCount);
        std::array<std::byte, 5> out{};
        pages.read(p, p + 1 == kCount ? 2 : size_t(rng.next_float() * 16000), out);
        for (const std::byte b : out) ASSERT_EQ(b, std::byte(p + 1));
    }
}

TEST(TexelPages, NameTheFolderThatCannotBeWritten) {
    const char* before = std::getenv("TMPDIR");
    const std::string kept = before ? before : "";
    ::setenv("TMPDIR", "/nowhere/at/all", 1);
    try {
        TexelPages pages(1);
        ADD_FAILURE() << "expected an error";
    } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::io);
        EXPECT_STREQ(e.what(),
                     "cannot create the temporary file of textures in '/nowhere/at/all': No such "
                     "file or directory");
    }
    before ? ::setenv("TMPDIR", kept.c_str(), 1) : ::unsetenv("TMPDIR");
}

/// Bytes that the images take under a limit; checks the number of warnings.
size_t bytes_within(const SceneDescription& scene, size_t limit, size_t warnings) {
    const TextureStore store(scene, limit);
    EXPECT_EQ(store.warnings().size(), warnings) << "limit " << limit;
    return store.memory();
}

TEST(TextureMemory, IsBoundedAndChangesNoValue) {
    const TemporaryFolder folder("texture_memory");
    TextureScene scene;
    for (int size : {8, 256, 16, 32, 256, 8, 8, 8, 8, 8, 256}) {
        const std::string name = "image" + std::to_string(scene.description.textures.size());
        std::vector<uint8_t> bytes(size_t(size * size * 3));
        Rng rng(uint64_t(size) + scene.description.textures.size());
        for (uint8_t& b : bytes) b = uint8_t(rng.next_float() * 256);
        scene.add(image_texture(folder.write_ppm(name + ".ppm", size, size, bytes)));
    }
    const auto levels = [](size_t size) {
        size_t texels = 0;
        for (; size > 0; size /= 2) texels += size * size;
        return 3 * texels;
    };
    const size_t all = 3 * levels(256) + levels(32) + levels(16) + 6 * levels(8);
    const auto& d = scene.description;
    EXPECT_EQ(bytes_within(d, kNoTextureLimit, 0), all);
    EXPECT_EQ(bytes_within(d, all, 0), all);
    const TextureStore whole(d);
    for (const size_t limit : {all - 1, all / 2, all / 4, all / 16, size_t(1)}) {
        EXPECT_LE(bytes_within(d, limit, 1), std::max(limit, TexelPages::kPageBytes));
        EXPECT_EQ(bytes_within(d, limit, 1), [&] {
            const ThreadLimit one(1);
            return TextureStore(d, limit).memory();
        }());
        const TextureStore paged(d, limit);
        for (TextureId id = 0; id < TextureId(d.textures.size()); ++id) {
            EXPECT_EQ(paged.mean(id), whole.mean(id));
            for (const auto& [st, footprint] : lookups())
                ASSERT_EQ(paged.eval(id, {st, {}}), whole.eval(id, {st, {}}));
        }
    }
}

}  // namespace
}  // namespace covtrace
