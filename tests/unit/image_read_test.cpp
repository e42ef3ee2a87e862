#include <cmath>
#include <limits>

#include "image/color_encoding.h"
#include "image/raster.h"
#include "image_test_files.h"

namespace covtrace {
namespace {

using namespace test;

class Read : public testing::Test {
  protected:
    fs::path file(const std::string& name, const std::string& bytes) {
        write_bytes(directory_ / name, bytes);
        return directory_ / name;
    }
    TemporaryDirectory directory_;
};

TEST_F(Read, PfmOfBothByteOrders) {
    // The two rows come from the bottom: the second row of the file is the top of the image.
    for (const bool big : {false, true}) {
        const auto f = file("a.pfm", "PF\n2 2\n" + std::string(big ? "1.0" : "-1.0") + "\n" +
                                         float_bytes({1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}, big));
        const Image image = read_image(f);
        EXPECT_EQ(image.display, (PixelBounds{0, 0, 2, 2}));
        EXPECT_EQ(image.rgb(0), Rgb(7, 8, 9));
        EXPECT_EQ(image.rgb(3), Rgb(4, 5, 6));
    }
    const auto grey = file("b.pfm", "Pf\n1 2\n-0.5\n" + float_bytes({1, -4}));
    EXPECT_EQ(read_image(grey).find("Y")->values, (std::vector<float>{-2, 0.5f}));
    const RasterImage raster = read_raster(grey);
    EXPECT_EQ(raster.channels, 1);
    EXPECT_FALSE(raster.is_8bit);
}

TEST_F(Read, PnmIsDecodedFromSrgbAsImageOnly) {
    const auto f = file("a.ppm", "P6\n# comment\n1 1 255\n" + bytes_of({255, 128, 0}));
    EXPECT_FLOAT_EQ(read_image(f).rgb(0).g, srgb_decode(128 / 255.0f));
    const RasterImage raster = read_raster(f);
    EXPECT_EQ(raster.bytes, (std::vector<uint8_t>{255, 128, 0}));
    EXPECT_TRUE(raster.is_8bit);
    const RasterImage grey =
        read_raster(file("b.pgm", "P5 2 1 65535\n" + bytes_of({255, 255, 0, 1})));
    EXPECT_EQ(grey.values, (std::vector<float>{1, 1 / 65535.0f}));
    EXPECT_TRUE(grey.is_16bit);
    EXPECT_FALSE(grey.is_8bit);
}

TEST_F(Read, HdrFlatOldAndNewRunLengths) {
    const std::string header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n";
    // The value is 128 * 2^(129 - 136) = 1.
    const RasterImage flat = read_raster(
        file("a.hdr", header + "-Y 1 +X 2\n" + bytes_of({128, 64, 0, 129, 9, 9, 9, 0})));
    EXPECT_EQ(flat.values, (std::vector<float>{1, 0.5f, 0, 0, 0, 0}));

    const RasterImage old =
        read_raster(file("b.hdr", header + "-Y 1 +X 4\n" +
                                      bytes_of({128, 128, 128, 129, 1, 1, 1, 2, 64, 0, 0, 129})));
    EXPECT_EQ(old.values, (std::vector<float>{1, 1, 1, 1, 1, 1, 1, 1, 1, 0.5f, 0, 0}));

    std::string rows;
    for (int y = 0; y < 2; ++y)
        rows += bytes_of({2, 2, 0, 8}) + bytes_of({128 + 8, y == 0 ? 128 : 64}) +
                bytes_of({3, 1, 2, 3, 128 + 5, 4}) + bytes_of({128 + 8, 0}) +
                bytes_of({128 + 8, 136});
    const RasterImage runs = read_raster(file("c.hdr", header + "-Y 2 +X 8\n" + rows));
    EXPECT_EQ(runs.values[0], 128);
    EXPECT_EQ(runs.values[1], 1);
    EXPECT_EQ(runs.values[7], 3);
    EXPECT_EQ(runs.values[3 * 7 + 1], 4);
    EXPECT_EQ(runs.values[3 * 8], 64);
    EXPECT_EQ(read_raster(file("d.hdr", header + "+Y 2 +X 8\n" + rows)).values[0], 64);
}

std::string targa_header(int type, int width, int height, int bits, int descriptor,
                         int colors = 0) {
    return bytes_of({0, colors > 0, type, 0, 0, colors, 0, colors > 0 ? 24 : 0, 0, 0, 0, 0, width,
                     0, height, 0, bits, descriptor});
}

TEST_F(Read, TargaOrientationsPalettesAndRuns) {
    const std::string pixels = bytes_of({0, 0, 255, 0, 255, 0});  // red, green
    const std::vector<uint8_t> red_green = {255, 0, 0, 0, 255, 0},
                               green_red = {0, 255, 0, 255, 0, 0};
    const auto raster = [&](const std::string& bytes) { return read_raster(file("a.tga", bytes)); };
    EXPECT_EQ(raster(targa_header(2, 2, 1, 24, 0x20) + pixels).bytes, red_green);
    EXPECT_EQ(raster(targa_header(2, 2, 1, 24, 0x30) + pixels).bytes, green_red);
    EXPECT_EQ(raster(targa_header(2, 1, 2, 24, 0x20) + pixels).bytes, red_green);
    EXPECT_EQ(raster(targa_header(2, 1, 2, 24, 0) + pixels).bytes, green_red);
    EXPECT_EQ(raster(targa_header(10, 2, 1, 24, 0x20) + bytes_of({1}) + pixels).bytes, red_green);
    EXPECT_EQ(raster(targa_header(10, 2, 1, 24, 0x20) + bytes_of({129, 0, 0, 255})).bytes,
              (std::vector<uint8_t>{255, 0, 0, 255, 0, 0}));
    EXPECT_EQ(raster(targa_header(1, 2, 1, 8, 0x20, 2) + pixels + bytes_of({1, 0})).bytes,
              green_red);
    EXPECT_EQ(raster(targa_header(3, 2, 1, 8, 0x20) + bytes_of({255, 51})).bytes,
              (std::vector<uint8_t>{255, 51}));
    EXPECT_EQ(raster(targa_header(2, 1, 1, 16, 0x20) + bytes_of({0x00, 0x7c})).bytes,
              (std::vector<uint8_t>{255, 0, 0}));
    // The fourth byte is alpha only where the descriptor says so.
    const std::string bgra = bytes_of({0, 0, 255, 51});
    EXPECT_EQ(raster(targa_header(2, 1, 1, 32, 0x20) + bgra).channels, 3);
    EXPECT_EQ(raster(targa_header(2, 1, 1, 32, 0x28) + bgra).bytes,
              (std::vector<uint8_t>{255, 0, 0, 51}));
}

TEST_F(Read, QoiChunks) {
    const std::string header = "qoif" + bytes_of({0, 0, 0, 5, 0, 0, 0, 1, 3, 0});
    // The pixels are RGB(10, 20, 30), difference (+1, 0, -1), by green (+4: red +5, blue +2), a run
    // of 2.
    const RasterImage raster =
        read_raster(file("a.qoi", header + bytes_of({0xfe, 10, 20, 30, 0x40 | 3 << 4 | 2 << 2 | 1,
                                                     0x80 | 36, 9 << 4 | 6, 0xc0 | 1})));
    std::vector<int> values;
    for (const uint8_t v : raster.bytes) values.push_back(v);
    EXPECT_EQ(values,
              (std::vector<int>{10, 20, 30, 11, 20, 29, 16, 24, 31, 16, 24, 31, 16, 24, 31}));
}

TEST_F(Read, QoiOfLinearColours) {
    const std::string pixel = bytes_of({0xff, 51, 102, 255, 204});
    for (const int channels : {3, 4}) {
        const RasterImage raster = read_raster(
            file("a.qoi", "qoif" + bytes_of({0, 0, 0, 1, 0, 0, 0, 1, channels, 1}) + pixel));
        EXPECT_FALSE(raster.is_8bit || raster.is_16bit);
        std::vector<float> expected{0.2f, 0.4f, 1.0f, 0.8f};
        expected.resize(size_t(channels));
        EXPECT_EQ(raster.values, expected);
    }
    const Image image = read_image(directory_ / "a.qoi");
    EXPECT_FLOAT_EQ(image.find("R")->values[0], 0.2f);
}

TEST_F(Read, Jpeg) {
    const RasterImage raster = read_raster(file("a.jpg", grey_jpeg()));
    EXPECT_EQ(raster.channels, 1);
    EXPECT_EQ(raster.bytes, std::vector<uint8_t>(64, 128));
}

TEST_F(Read, Webp) {
    const std::vector<uint8_t> rgba{255, 0, 0, 255, 0, 255, 0, 128, 0, 0, 255, 255, 9, 8, 7, 255};
    const RasterImage exact = read_raster(file("a.webp", webp_file(rgba, 2, 2, true)));
    EXPECT_EQ(exact.channels, 4);
    EXPECT_TRUE(exact.is_8bit);
    EXPECT_EQ(exact.bytes, rgba);
    // Opaque ones have no alpha; a grey square is grey with loss, too.
    const std::vector<uint8_t> grey(4 * 16 * 16, 255);
    const RasterImage lossy = read_raster(file("b.webp", webp_file(grey, 16, 16, false)));
    EXPECT_EQ(lossy.channels, 3);
    EXPECT_EQ(lossy.bytes, std::vector<uint8_t>(3 * 16 * 16, 255));
    const Image image = read_image(directory_ / "a.webp");
    EXPECT_FLOAT_EQ(image.find("A")->values[1], 128 / 255.0f);
}

TEST_F(Read, WebpAnimationsAreRefused) {
    // An extended header that says so, behind which nothing counts any more.
    const std::string header = "RIFF" + bytes_of({22, 0, 0, 0}) + "WEBPVP8X" +
                               bytes_of({10, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 3, 0, 0}) + "ANIM";
    const fs::path animation = file("a.webp", header + std::string(40, '\0'));
    const std::string text = error_of([&] { read_image(animation); }).what();
    EXPECT_NE(text.find("it is an animation"), std::string::npos) << text;
}

TEST_F(Read, RasterOfExrTakesTheRootLayerAndRepairs) {
    const float inf = std::numeric_limits<float>::infinity();
    Image image{{2, 3, 4, 4}, {0, 0, 10, 10}, {}, {}};
    image.add_channel("albedo.R").values = {9, 1000};
    image.add_channel("R").values = {1, inf};
    image.add_channel("G").values = {-50, std::numeric_limits<float>::quiet_NaN()};
    image.add_channel("B").values = {3, -inf};
    write_exr(image, directory_ / "a.exr");
    const RasterImage raster = read_raster(directory_ / "a.exr");
    EXPECT_EQ(raster.values, (std::vector<float>{1, -50, 3, 50, 0, -50}));
    EXPECT_EQ(raster.repaired, 3);
    EXPECT_FALSE(raster.is_8bit);
    EXPECT_EQ(raster.colour_space, ColourSpace::srgb);
    image.metadata[kChromaticities] =
        std::vector<float>{0.708f, 0.292f, 0.17f, 0.797f, 0.131f, 0.046f, 0.3127f, 0.329f};
    write_exr(image, directory_ / "a.exr");
    EXPECT_EQ(read_raster(directory_ / "a.exr").colour_space, ColourSpace::rec2020);
    image.metadata[kChromaticities] = std::vector<float>(8, 0.5f);
    write_exr(image, directory_ / "a.exr");
    EXPECT_EQ(read_raster(directory_ / "a.exr").colour_space, std::nullopt);
    EXPECT_EQ(read_raster(directory_ / "a.exr").values, raster.values);
    EXPECT_TRUE(std::isinf(read_image(directory_ / "a.exr").rgb(1).r));

    image.channels.erase(image.channels.begin() + 1);
    write_exr(image, directory_ / "b.exr");
    EXPECT_NE(std::string(error_of([&] { read_raster(directory_ / "b.exr"); }).what())
                  .find("no channels R, G, B or Y"),
              std::string::npos);
}

TEST_F(Read, MissingFilesAndTheirPlace) {
    const fs::path missing = directory_ / "missing.png";
    EXPECT_STREQ(error_of([&] { read_image(missing); }).what(),
                 ("cannot open '" + missing.string() + "': No such file or directory").c_str());
    const SourceLocation where{std::make_shared<const std::string>("scene.pbrt"), 7, 3};
    const Error error = error_of([&] { read_raster(missing, where); });
    EXPECT_EQ(error.kind(), ErrorKind::scene);
    EXPECT_STREQ(error.what(), ("scene.pbrt:7:3: cannot open '" + missing.string() +
                                "': No such file or directory")
                                   .c_str());
    EXPECT_STREQ(error_of([&] { read_image(directory_.path()); }).what(),
                 ("cannot open '" + directory_.path().string() + "': Is a directory").c_str());
}

}  // namespace
}  // namespace covtrace
