// Pictures in formats that hold the colour alone: written pictures are read back.
#include <sys/stat.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/file_kind.h"
#include "image/write_image.h"
#include "image_test_files.h"

namespace covtrace {
namespace {

using namespace test;

Image picture(int width, int height, const std::vector<std::string>& names) {
    Image image;
    image.data = image.display = {0, 0, width, height};
    for (const std::string& name : names) image.add_channel(name);
    return image;
}

TEST(WrittenFormat, FollowsTheEnding) {
    EXPECT_EQ(written_format("a.exr"), WrittenFormat::exr);
    EXPECT_EQ(written_format("a.b/image"), WrittenFormat::exr);
    EXPECT_EQ(written_format("/dev/stdout"), WrittenFormat::exr);
    EXPECT_EQ(written_format("a.exr.PNG"), WrittenFormat::png);
    EXPECT_EQ(written_format("a.Pfm"), WrittenFormat::pfm);
    EXPECT_EQ(written_format("a.hdr"), WrittenFormat::hdr);
    EXPECT_FALSE(written_format("a.jpg"));
    EXPECT_FALSE(written_format("a.exr."));
}

TEST(WriteImage, RefusesOtherNames) {
    TemporaryDirectory directory;
    const fs::path file = directory / "a.tif";
    try {
        write_image(picture(2, 2, {"R", "G", "B"}), file);
        FAIL();
    } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::usage);
        for (const char* fragment : {"a.tif", ".exr", ".png", ".pfm", ".hdr"})
            EXPECT_NE(std::string(e.what()).find(fragment), std::string::npos) << e.what();
    }
    EXPECT_FALSE(fs::exists(file));
}

TEST(WriteImage, AnImageWithoutColourIsAnError) {
    TemporaryDirectory directory;
    for (const char* name : {"a.png", "a.pfm", "a.hdr"})
        EXPECT_THROW(write_image(picture(2, 2, {"Z"}), directory / name), Error) << name;
    EXPECT_TRUE(fs::is_empty(directory.path()));
}

TEST(Pfm, KeepsEveryBitAndNothingElse) {
    TemporaryDirectory directory;
    std::mt19937 random(1);
    for (const auto& names : {std::vector<std::string>{"R", "G", "B"}, {"Y"}}) {
        Image image = picture(5, 3, names);
        for (Channel& c : image.channels)
            for (float& v : c.values) v = std::bit_cast<float>(uint32_t(random()));
        image.channels[0].values[4] = -std::numeric_limits<float>::infinity();
        Image layers = image;
        layers.add_channel("Z");
        write_image(layers, directory / "a.pfm");
        const Image read = read_image(directory / "a.pfm");
        ASSERT_EQ(read.channels.size(), names.size());
        EXPECT_EQ(read.data, image.data);
        for (size_t c = 0; c < names.size(); ++c)
            for (size_t i = 0; i < image.pixel_count(); ++i)
                EXPECT_EQ(std::bit_cast<uint32_t>(read.channels[c].values[i]),
                          std::bit_cast<uint32_t>(image.channels[c].values[i]));
    }
}

// The widths are of all kinds: below 8 and above 32767 rows have no run lengths; repeated pixels
// make runs of all lengths, single ones the bytes between them.
TEST(Hdr, IsAsCloseAsItsMantissas) {
    TemporaryDirectory directory;
    std::mt19937 random(2);
    std::uniform_real_distribution<float> exponent(-100, 100);
    std::uniform_int_distribution<int> run(1, 300), singles(0, 3);
    for (const int width : {1, 7, 8, 9, 127, 129, 1000, 32767, 32768}) {
        Image image = picture(width, 2, {"R", "G", "B"});
        for (Channel& c : image.channels)
            for (size_t i = 0; i < c.values.size();) {
                const float value = std::exp2(exponent(random));
                const int length = singles(random) ? 1 : run(random);
                for (int k = 0; k < length && i < c.values.size(); ++k) c.values[i++] = value;
            }
        write_image(image, directory / "a.hdr");
        const Image read = read_image(directory / "a.hdr");
        ASSERT_EQ(read.data, image.data) << width;
        for (size_t i = 0; i < image.pixel_count(); ++i) {
            const Rgb is = read.rgb(i), should = image.rgb(i);
            const float largest = std::max({should.r, should.g, should.b});
            for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(is[c], should[c], largest / 255) << width << " pixel " << i;
        }
    }
}

TEST(Hdr, HoldsWhatTheFormatCannotAsTheNearest) {
    TemporaryDirectory directory;
    constexpr float kInf = std::numeric_limits<float>::infinity();
    const std::vector<float> values{-1, std::nanf(""), 0, kInf, 3e38f, 1e-40f, 255.7f / 256, 1};
    Image image = picture(int(values.size()), 1, {"Y"});
    image.channels[0].values = values;
    write_image(image, directory / "a.hdr");
    const Image read = read_image(directory / "a.hdr");
    const float most = std::ldexp(255.0f, 119);
    const std::vector<float> expected{0, 0, 0, most, most, 0, 1, 1};
    for (size_t i = 0; i < values.size(); ++i) EXPECT_EQ(read.rgb(i), Rgb(expected[i])) << i;
}

TEST(FileKind, TellsWhatIsNoFile) {
    TemporaryDirectory directory;
    write_bytes(directory / "file", "x");
    ASSERT_EQ(::mkfifo((directory / "pipe").c_str(), 0600), 0);
    fs::create_symlink("pipe", directory / "link");
    EXPECT_EQ(irregular_kind(directory / "file"), "");
    EXPECT_EQ(irregular_kind(directory / "none"), "");
    EXPECT_EQ(irregular_kind(directory.path()), "a folder");
    EXPECT_EQ(irregular_kind(directory / "link"), "a named pipe");
    EXPECT_EQ(irregular_kind("/dev/null"), "a device");
    // The pipe has no reader: opening it to write would not return.
    for (const char* name : {"pipe", "link"})
        EXPECT_THROW(write_exr(picture(1, 1, {"Y"}), directory / name), Error);
}

}  // namespace
}  // namespace covtrace
