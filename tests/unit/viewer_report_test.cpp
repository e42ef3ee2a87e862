#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <zlib.h>

#include <bit>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>

#include "core/base64.h"
#include "viewer/encode_plane.h"
#include "viewer/report.h"

namespace covtrace::viewer {
namespace {

std::vector<uint8_t> from_base64(const std::string& text) {
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::vector<uint8_t> bytes;
    uint32_t group = 0;
    int bits = 0;
    for (char c : text) {
        if (c == '=') break;
        group = group << 6 | uint32_t(digits.find(c));
        bits += 6;
        if (bits >= 8) bytes.push_back(uint8_t(group >> (bits -= 8)));
    }
    return bytes;
}

float half_value(uint16_t bits) {
    const int exponent = bits >> 10 & 31, fraction = bits & 1023;
    const double size = exponent == 0    ? std::ldexp(fraction, -24)
                        : exponent == 31 ? (fraction ? NAN : INFINITY)
                                         : std::ldexp(1024 + fraction, exponent - 25);
    return float(bits & 0x8000 ? -size : size);
}

std::vector<float> decode(const EncodedPlane& plane, size_t count) {
    const size_t size = plane.half ? 2 : 4;
    const std::vector<uint8_t> deflated = from_base64(plane.text);
    std::vector<uint8_t> bytes(count * size);
    uLongf length = bytes.size();
    EXPECT_EQ(uncompress(bytes.data(), &length, deflated.data(), deflated.size()), Z_OK);
    EXPECT_EQ(length, bytes.size());
    std::vector<float> values;
    for (size_t i = 0; i < count; ++i) {
        uint32_t bits = 0;
        for (size_t k = 0; k < size; ++k) bits |= uint32_t(bytes[k * count + i]) << (8 * k);
        values.push_back(plane.half ? half_value(uint16_t(bits)) : std::bit_cast<float>(bits));
    }
    return values;
}

TEST(EncodePlane, Base64OfRfc4648) {
    const auto encode = [](std::string_view text) {
        return base64({reinterpret_cast<const uint8_t*>(text.data()), text.size()});
    };
    EXPECT_EQ(encode(""), "");
    EXPECT_EQ(encode("f"), "Zg==");
    EXPECT_EQ(encode("fo"), "Zm8=");
    EXPECT_EQ(encode("foo"), "Zm9v");
    EXPECT_EQ(encode("foobar"), "Zm9vYmFy");
}

TEST(EncodePlane, EveryHalfIsStoredAsOne) {
    std::vector<float> values;
    for (uint32_t bits = 0; bits < 65536; ++bits)
        if ((bits & 0x7c00) != 0x7c00 || (bits & 0x3ff) == 0)
            values.push_back(half_value(uint16_t(bits)));
    const EncodedPlane plane = encode_plane(values);
    EXPECT_TRUE(plane.half);
    const std::vector<float> decoded = decode(plane, values.size());
    for (size_t i = 0; i < values.size(); ++i)
        EXPECT_EQ(std::bit_cast<uint32_t>(decoded[i]), std::bit_cast<uint32_t>(values[i]));
}

TEST(EncodePlane, WhatIsNoHalfStaysAFloat) {
    for (float v :
         {0.1f, 65536.0f, 65520.0f, 1e-8f, std::ldexp(1.0f, -25), 1.0f + std::ldexp(1.0f, -11),
          std::numeric_limits<float>::max(), std::numeric_limits<float>::denorm_min()}) {
        const EncodedPlane plane = encode_plane(std::vector<float>{1, v});
        EXPECT_FALSE(plane.half) << v;
        EXPECT_EQ(decode(plane, 2), (std::vector<float>{1, v}));
    }
    EXPECT_TRUE(std::isnan(decode(encode_plane(std::vector<float>{NAN, 0.1f}), 2)[0]));
}

RC_GTEST_PROP(EncodePlane, IsLossless, (std::vector<uint32_t> bits)) {
    std::vector<float> values;
    for (uint32_t b : bits)
        if (!std::isnan(std::bit_cast<float>(b))) values.push_back(std::bit_cast<float>(b));
    const std::vector<float> decoded = decode(encode_plane(values), values.size());
    for (size_t i = 0; i < values.size(); ++i)
        RC_ASSERT(std::bit_cast<uint32_t>(decoded[i]) == std::bit_cast<uint32_t>(values[i]));
}

class WriteReport : public testing::Test {
  protected:
    /// An image whose channels are all filled with noise that does not compress.
    static Image noise(const std::vector<std::string>& channels) {
        Image image{{0, 0, 64, 32}, {0, 0, 64, 32}, {}, {}};
        uint32_t state = 1;
        for (const std::string& name : channels)
            for (float& v : image.add_channel(name).values)
                v = std::bit_cast<float>(0x3f800000u |
                                         (state = state * 1664525u + 1013904223u) >> 9);
        return image;
    }
    std::filesystem::path file_ =
        std::filesystem::path(testing::TempDir()) /
        (std::string("report-") + testing::UnitTest::GetInstance()->current_test_info()->name());
    ~WriteReport() override { std::filesystem::remove(file_); }
};

TEST_F(WriteReport, LeavesOutWhatDoesNotFit) {
    const Image image = noise({"R", "G", "B", "variance.R", "variance.G", "variance.B", "error.Y"});
    const Report report{"title", {{"name", &image, {}, {}}}, {}, {}};
    EXPECT_TRUE(write_report(report, file_).empty());
    // A channel is 64 * 32 * 4 bytes, not much less when deflated, times 4/3: four of them fit,
    // seven don't.
    const std::vector<OmittedLayer> omitted = write_report(report, file_, 50000);
    ASSERT_EQ(omitted.size(), 1u);
    EXPECT_EQ(omitted[0].layer, "variance");
    std::stringstream page;
    page << std::ifstream(file_).rdbuf();
    EXPECT_NE(page.str().find("\"omitted\":[\"variance\"]"), std::string::npos);
    EXPECT_LT(page.str().size(), 50000 + 100000u);  // the page itself
}

TEST_F(WriteReport, RefusesColoursThatDoNotFit) {
    const Image image = noise({"R", "G", "B"});
    try {
        write_report({"title", {{"name", &image, {}, {}}}, {}, {}}, file_, 10000);
        FAIL();
    } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::limit);
        EXPECT_NE(std::string(e.what()).find("crop"), std::string::npos);
    }
    EXPECT_FALSE(std::filesystem::exists(file_));
}

TEST_F(WriteReport, RefusesImagesOfDifferentPixels) {
    const Image image = noise({"R", "G", "B"});
    Image other = cropped(image, {0, 0, 8, 8});
    const Report report{"t", {{"a", &image, {}, {}}, {"b", &other, {}, {}}}, {}, {}};
    EXPECT_THROW(write_report(report, file_), Error);
}

}  // namespace
}  // namespace covtrace::viewer
