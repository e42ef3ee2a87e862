// Values that are not finite: replaced, counted, located.
#include "image/finite_pixels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace covtrace {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
constexpr float kLargest = std::numeric_limits<float>::max();

/// 3x3 pixels from (10, 20) on, of which pixel i has the value i.
Image counted(const std::vector<std::string>& channels) {
    Image image;
    image.data = image.display = {10, 20, 13, 23};
    for (const std::string& name : channels) {
        std::vector<float>& values = image.add_channel(name).values;
        for (size_t i = 0; i < values.size(); ++i) values[i] = float(i);
    }
    return image;
}

TEST(FinitePixels, FiniteImagesStayAsTheyAre) {
    Image image = counted({"R", "variance.R"});
    image.metadata["spp"] = 4.0f;
    EXPECT_FALSE(replace_nonfinite(image));
    EXPECT_EQ(image.channels[1].values[8], 8);
    EXPECT_EQ(image.metadata.size(), 1u);
    EXPECT_FALSE(replaced_pixels(image.metadata));
}

TEST(FinitePixels, InfiniteValuesBecomeTheLargest) {
    Image image = counted({"R"});
    image.channels[0].values[4] = kInfinity;
    image.channels[0].values[5] = -kInfinity;
    ASSERT_TRUE(replace_nonfinite(image));
    EXPECT_EQ(image.channels[0].values[4], kLargest);
    EXPECT_EQ(image.channels[0].values[5], -kLargest);
    EXPECT_EQ(image.channels[0].values[3], 3);
}

TEST(FinitePixels, NaNsBecomeTheMeanOfTheirFiniteNeighbours) {
    Image image = counted({"R"});
    auto& values = image.channels[0].values;
    values[0] = values[8] = kNone;
    values[4] = kInfinity;
    ASSERT_TRUE(replace_nonfinite(image));
    EXPECT_EQ(values[0], 2);  // mean of 1 and 3
    EXPECT_EQ(values[8], 6);  // mean of 5 and 7
    Image nothing = counted({"R"});
    for (float& v : nothing.channels[0].values) v = kNone;
    ASSERT_TRUE(replace_nonfinite(nothing));
    for (const float v : nothing.channels[0].values) EXPECT_EQ(v, 0);
}

TEST(FinitePixels, UnknownErrorsAreTheLargest) {
    for (const char* name : {"variance.G", "error.Y"}) {
        Image image = counted({name});
        image.channels[0].values[4] = kNone;
        ASSERT_TRUE(replace_nonfinite(image));
        EXPECT_EQ(image.channels[0].values[4], kLargest) << name;
    }
}

TEST(FinitePixels, CountsPixelsNotValuesAndNamesTheFirst) {
    Image image = counted({"R", "G", "B", "variance.R", "variance.G", "Z", "error.Y"});
    image.channels[0].values[7] = kNone;
    image.channels[2].values[7] = kNone;
    image.channels[3].values[7] = image.channels[4].values[5] = kInfinity;
    image.channels[5].values[8] = kInfinity;
    const auto replaced = replace_nonfinite(image);
    ASSERT_TRUE(replaced);
    EXPECT_EQ(replaced->pixels, 3);
    EXPECT_EQ(replaced->x, 12);
    EXPECT_EQ(replaced->y, 21);
    EXPECT_EQ(replaced->layers, "image, variance, Z");
    const auto told = replaced_pixels(image.metadata);
    ASSERT_TRUE(told);
    EXPECT_EQ(told->pixels, 3);
    EXPECT_EQ(told->x, 12);
    EXPECT_EQ(told->y, 21);
    EXPECT_EQ(describe(*told).substr(0, 13), "3 pixels have");
    EXPECT_NE(describe(*told).find("first at 12,21, in the layers image, variance, Z"),
              std::string::npos);
}

TEST(FinitePixels, MetadataIsFinite) {
    Image image = counted({"R"});
    image.metadata["worldToNDC"] = std::vector<float>{1, kNone};
    image.metadata["focus"] = kInfinity;
    image.metadata["note"] = std::string("nan");
    EXPECT_FALSE(replace_nonfinite(image));
    EXPECT_EQ(image.metadata.size(), 1u);
}

}  // namespace
}  // namespace covtrace
