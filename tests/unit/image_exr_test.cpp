#include <cmath>
#include <limits>

#include "image_test_files.h"

namespace covtrace {
namespace {

using namespace test;

TEST(Exr, KeepsBitsNamesWindowsAndMetadata) {
    TemporaryDirectory directory;
    const fs::path file = directory / "a.exr";
    Image image = random_image({-3, 5, 60, 105}, {-10, 0, 100, 200},
                               {"R", "G", "B", "A", "raw.R", "cov.00", "cov.44", "Z"}, 1);
    const float inf = std::numeric_limits<float>::infinity();
    image.channels[0].values[0] = std::numeric_limits<float>::quiet_NaN();
    image.channels[0].values[1] = std::bit_cast<float>(0x7fa12345u);  // a NaN with a payload
    image.channels[0].values[2] = inf;
    image.channels[0].values[3] = -inf;
    image.channels[0].values[4] = -0.0f;
    image.channels[0].values[5] = std::numeric_limits<float>::denorm_min();
    image.metadata["spp"] = 64;
    image.metadata["seconds"] = 1.25f;
    image.metadata["commit"] = std::string("0123456789abcdef");
    image.metadata["an attribute with a name of more than 31 bytes"] = std::string();
    image.metadata["worldToCamera"] =
        std::vector<float>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};
    image.metadata["m33"] = std::vector<float>{1, 2, 3, 4, 5, 6, 7, 8, 9};
    image.metadata["v2"] = std::vector<float>{1, 2};
    image.metadata["v3"] = std::vector<float>{1, 2, 3};
    image.metadata["list"] = std::vector<float>{1, 2, 3, 4, 5};
    image.metadata["one"] = std::vector<float>{1};
    image.metadata[kChromaticities] =
        std::vector<float>{0.708f, 0.292f, 0.17f, 0.797f, 0.131f, 0.046f, 0.3127f, 0.329f};
    image.metadata["pixelAspectRatio"] = 2.0f;
    write_exr(image, file);

    const Image back = read_image(file);
    EXPECT_EQ(back.data, image.data);
    EXPECT_EQ(back.display, image.display);
    EXPECT_EQ(back.metadata, image.metadata);
    ASSERT_EQ(back.channels.size(), image.channels.size());
    for (const Channel& channel : image.channels) {
        const Channel* other = back.find(channel.name);
        ASSERT_TRUE(other) << channel.name;
        EXPECT_TRUE(same_bits(other->values, channel.values)) << channel.name;
    }
}

TEST(Exr, SmallestAndOddSizes) {
    TemporaryDirectory directory;
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 33}, {1000, 1}, {17, 16}, {15, 65}}) {
        const Image image = random_image({0, 0, width, height}, {0, 0, width, height}, {"Y"}, 7);
        write_exr(image, directory / "a.exr");
        const Image back = read_image(directory / "a.exr");
        EXPECT_TRUE(same_bits(back.channels.at(0).values, image.channels[0].values));
    }
}

TEST(Exr, BytesDoNotDependOnThreads) {
    TemporaryDirectory directory;
    const Image image = random_image({0, 0, 200, 300}, {0, 0, 200, 300}, {"R", "G", "B"}, 3);
    write_exr(image, directory / "one.exr", 1);
    write_exr(image, directory / "four.exr", 4);
    EXPECT_EQ(read_bytes(directory / "one.exr"), read_bytes(directory / "four.exr"));
}

TEST(Exr, RefusesImagesThatAreNotWellFormed) {
    TemporaryDirectory directory;
    const Image good = random_image({0, 0, 4, 4}, {0, 0, 4, 4}, {"R", "G"}, 1);
    const auto expect_refused = [&](const Image& image, const std::string& reason) {
        const Error error = error_of([&] { write_exr(image, directory / "a.exr"); });
        EXPECT_EQ(error.kind(), ErrorKind::internal);
        EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
        EXPECT_TRUE(fs::is_empty(directory.path()));
    };
    Image image = good;
    image.channels.clear();
    expect_refused(image, "no channels");
    image = good;
    image.data = {0, 0, 0, 4};
    expect_refused(image, "no pixels");
    image = good;
    image.display = {4, 0, 0, 4};
    expect_refused(image, "display window");
    image = good;
    image.channels[1].values.pop_back();
    expect_refused(image, "channel 'G' has the wrong number");
    image = good;
    image.channels[1].name = "R";
    expect_refused(image, "two channels are called 'R'");
    image = good;
    image.channels[1].name.clear();
    expect_refused(image, "no name for a channel");
    // Readers interpret "version" themselves and refuse the file where it is a string.
    image = good;
    image.metadata["version"] = std::string("1.0");
    expect_refused(image, "'version'");
    image = good;
    image.metadata["dataWindow"] = 3;
    expect_refused(image, "'dataWindow'");
    image = good;
    image.metadata["pixelAspectRatio"] = 0.0f;
    expect_refused(image, "'pixelAspectRatio' is no number");
}

TEST(Image, FindsChannelsAndColors) {
    Image image{{0, 0, 2, 1}, {0, 0, 2, 1}, {}, {}};
    for (const char* name : {"R", "G", "B", "raw.R", "raw.G"}) image.add_channel(name);
    image.channels[1].values = {3, 4};
    EXPECT_EQ(image.rgb(1), Rgb(0, 4, 0));
    EXPECT_EQ(image.find("raw.B"), nullptr);
    EXPECT_THROW(image.rgb(0, "raw."), std::out_of_range);
    EXPECT_THROW(image.rgb(2), std::out_of_range);
    EXPECT_EQ(image.add_channel("Z").values, std::vector<float>(2, 0.0f));
}

TEST(Image, DescribesItself) {
    Image image{{1, 0, 3, 1}, {0, 0, 4, 2}, {}, {}};
    image.add_channel("R").values = {1, 3};
    image.add_channel("raw.R").values = {std::numeric_limits<float>::quiet_NaN(), 5};
    image.metadata["spp"] = 16;
    image.metadata["scene"] = std::string("a.pbrt");
    const std::string text = describe(image);
    for (const char* line :
         {"display window: 4x2 pixels, x 0 to 4, y 0 to 2\n", "data window: 2x1 pixels, x 1 to 3",
          "  (root)\n    R: 1 to 3, mean 2\n", "  raw\n    R: 5 to 5, mean 5, 1 not finite\n",
          "  spp = 16\n", "  scene = \"a.pbrt\"\n"})
        EXPECT_NE(text.find(line), std::string::npos) << line << "\nin\n" << text;
}

}  // namespace
}  // namespace covtrace
