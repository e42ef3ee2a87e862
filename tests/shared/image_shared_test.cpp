// Image files that others made to test or to break readers.
#include <gtest/gtest.h>

#include "tests/shared/shared_folder.h"
#include "tests/unit/image_reading_contract.h"
#include "tests/unit/image_test_files.h"

namespace covtrace {
namespace {

using namespace test;

TEST(SharedImages, PngKindsOfTheSuite) {
    const fs::path suite = shared_folder() / "malformed/pngsuite";
    struct Kind {
        const char* name;
        int channels;
        bool sixteen;
    };
    // The names go on with 0: grey, 2: colour, 3p: palette, 4a and 6a: with alpha, then the bits.
    // The alpha of grey images is dropped; transparent colours become alpha.
    for (const Kind& k : {Kind{"basn0g01", 1, false},
                          {"basn0g02", 1, false},
                          {"basn0g04", 1, false},
                          {"basn0g08", 1, false},
                          {"basn0g16", 1, true},
                          {"basn2c08", 3, false},
                          {"basn2c16", 3, true},
                          {"basn3p01", 3, false},
                          {"basn3p08", 3, false},
                          {"basn4a08", 1, false},
                          {"basn4a16", 1, true},
                          {"basn6a08", 4, false},
                          {"basn6a16", 4, true},
                          {"ftbwn3p08", 4, false}}) {
        const RasterImage plain = read_raster(suite / (std::string(k.name) + ".png"));
        EXPECT_EQ(plain.channels, k.channels) << k.name;
        EXPECT_EQ(plain.is_16bit, k.sixteen) << k.name;
        EXPECT_EQ(plain.is_8bit, !k.sixteen) << k.name;
        const RasterImage interlaced = read_raster(suite / ("i" + std::string(k.name) + ".png"));
        EXPECT_EQ(plain.values, interlaced.values) << k.name;
        EXPECT_EQ(plain.bytes, interlaced.bytes) << k.name;
    }
    // A horizontal ramp from black to white in 1-bit grey has only these two values.
    for (uint8_t v : read_raster(suite / "basn0g01.png").bytes) EXPECT_TRUE(v == 0 || v == 255);
    const Image alpha = read_image(suite / "basn4a08.png");
    ASSERT_TRUE(alpha.find("Y") && alpha.find("A"));
}

TEST(SharedImages, DamagedFilesGiveAnImageOrOneLine) {
    TemporaryDirectory directory;
    PrintCounter printed(directory / "printed");
    size_t files = 0;
    for (const auto& entry : fs::recursive_directory_iterator(shared_folder() / "malformed"))
        if (entry.is_regular_file()) {
            EXPECT_EQ(problem_of(entry.path()), "") << entry.path();
            ++files;
        }
    EXPECT_GT(files, 0u);
    EXPECT_EQ(printed.bytes(), 0u);
}

}  // namespace
}  // namespace covtrace
