#include <cmath>
#include <limits>

#include "image/color_encoding.h"
#include "image/compare.h"
#include "image_test_files.h"

namespace covtrace {
namespace {

using namespace test;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

Image uniform(int width, int height, Rgb color) {
    Image image{{0, 0, width, height}, {0, 0, width, height}, {}, {}};
    for (int c = 0; c < 3; ++c)
        image.add_channel(std::string(1, "RGB"[c])).values.assign(image.pixel_count(), color[c]);
    return image;
}

TEST(Compare, EqualImages) {
    const Comparison c = compare(uniform(8, 4, {0.1f, 0.2f, 3}), uniform(8, 4, {0.1f, 0.2f, 3}));
    EXPECT_EQ(c.mse, 0);
    EXPECT_EQ(c.relmse, 0);
    EXPECT_EQ(c.relmse_trimmed, 0);
    EXPECT_EQ(c.relmse_median, 0);
    EXPECT_EQ(c.psnr, kInf);
    EXPECT_EQ(c.flip, 0);
    EXPECT_EQ(c.mean_ratio, (std::array<double, 3>{1, 1, 1}));
    EXPECT_EQ(c.nonfinite, 0);
    EXPECT_EQ(c.pixels, 32);
    EXPECT_TRUE(c.identical);
}

TEST(Compare, MeasuresByHand) {
    const Comparison c = compare(uniform(2, 2, {1, 0.5f, 0}), uniform(2, 2, {0.5f, 0.5f, 0.25f}));
    EXPECT_DOUBLE_EQ(c.mse, (0.25 + 0 + 0.0625) / 3);
    EXPECT_DOUBLE_EQ(c.relmse, (0.25 / 0.26 + 0.0625 / 0.0725) / 3);
    const double half = srgb_encode(0.5f), quarter = srgb_encode(0.25f);
    EXPECT_NEAR(c.psnr, -10 * std::log10(((1 - half) * (1 - half) + quarter * quarter) / 3), 1e-6);
    EXPECT_EQ(c.mean_ratio, (std::array<double, 3>{2, 1, 0}));
    EXPECT_FALSE(c.identical);
}

TEST(Compare, PsnrClampsToTheDisplay) {
    EXPECT_EQ(compare(uniform(2, 2, Rgb(5)), uniform(2, 2, Rgb(1))).psnr, kInf);
    EXPECT_EQ(compare(uniform(2, 2, Rgb(-5)), uniform(2, 2, Rgb(0))).psnr, kInf);
    EXPECT_NEAR(compare(uniform(2, 2, Rgb(0)), uniform(2, 2, Rgb(1))).psnr, 0, 1e-5);
}

TEST(Compare, TrimsTheFloorOfAThousandth) {
    // The 2 worst of 2999 pixels are left out, the third worst remains.
    const Image reference = uniform(2999, 1, Rgb(0));
    Image image = reference;
    for (size_t i : {5u, 500u, 2998u}) image.channels[1].values[i] = 1;
    Comparison c = compare(image, reference);
    EXPECT_NEAR(c.relmse, 3 * 100.0 / 3 / 2999, 1e-9);
    EXPECT_NEAR(c.relmse_trimmed, 100.0 / 3 / 2997, 1e-9);
    // No pixel is left out below a thousand of them.
    c = compare(uniform(999, 1, Rgb(1)), uniform(999, 1, Rgb(0)));
    EXPECT_DOUBLE_EQ(c.relmse_trimmed, c.relmse);
}

TEST(Compare, LeavesOutWhatIsNotFinite) {
    const Image reference = uniform(4, 1, Rgb(1));
    Image image = uniform(4, 1, Rgb(2));
    image.channels[0].values[1] = kNan;
    image.channels[2].values[1] = kInf;
    image.add_channel("Z").values = {kInf, 0, 0, 0};  // not a colour: the pixel is compared
    Comparison c = compare(image, reference);
    EXPECT_EQ(c.nonfinite, 3);
    EXPECT_EQ(c.pixels, 3);
    EXPECT_DOUBLE_EQ(c.mse, 1);
    EXPECT_TRUE(std::isfinite(c.flip));
    // A pixel of the reference without a value cannot be compared either, but is not counted.
    c = compare(reference, image);
    EXPECT_EQ(c.nonfinite, 0);
    EXPECT_EQ(c.pixels, 3);
    c = compare(uniform(2, 2, Rgb(kNan)), uniform(2, 2, Rgb(1)));
    EXPECT_EQ(c.nonfinite, 12);
    EXPECT_TRUE(std::isnan(c.mse) && std::isnan(c.flip) && std::isnan(c.relmse_trimmed) &&
                std::isnan(c.relmse_median));
}

/// Ten columns of blocks, 80 x 16 pixels: the first is dark, the others lie between 1 and 1.8.
Image dark_wall_beside_windows() {
    Image image = uniform(80, 16, Rgb(1));
    for (Channel& channel : image.channels)
        for (size_t i = 0; i < channel.values.size(); ++i) {
            const size_t block = i % 80 / 8;
            channel.values[i] = block == 0 ? 0.01f : 0.9f + 0.1f * float(block);
        }
    return image;
}

void scale(Image& image, float factor) {
    for (Channel& channel : image.channels)
        for (float& v : channel.values) v *= factor;
}

TEST(Compare, DecilesSeeWhatIsDark) {
    const Image reference = dark_wall_beside_windows();
    Image image = reference;
    // The wall keeps 0.4 of its light; what it lost lies on the brightest windows.
    for (Channel& channel : image.channels)
        for (size_t i = 0; i < channel.values.size(); ++i) {
            if (i % 80 / 8 == 0) channel.values[i] *= 0.4f;
            if (i % 80 / 8 == 9) channel.values[i] += 0.006f;
        }
    const Comparison c = compare(image, reference);
    for (double ratio : c.mean_ratio) EXPECT_NEAR(ratio, 1, 1e-6);
    EXPECT_NEAR(c.decile_ratio[0], 0.4, 1e-6);
    for (size_t k = 1; k < 9; ++k) EXPECT_DOUBLE_EQ(c.decile_ratio[k], 1);
    EXPECT_NEAR(c.decile_ratio[9], 1.806 / 1.8, 1e-6);
}

TEST(Compare, DecilesAreOfTheLuminance) {
    const Image reference = dark_wall_beside_windows();
    Image image = reference;
    for (float& v : image.channels[1].values) v *= 2;  // G
    for (double ratio : compare(image, reference).decile_ratio) EXPECT_NEAR(ratio, 1.7152, 1e-6);
}

TEST(Compare, DecilesOfACropAndOfPixelsThatAreFinite) {
    const Image reference = dark_wall_beside_windows();
    Image image = reference;
    scale(image, 3);
    image.channels[0].values[0] = kInf;
    image.channels[2].values[79] = kNan;
    for (double ratio : compare(image, reference).decile_ratio) EXPECT_NEAR(ratio, 3, 1e-6);
    // The crop is two blocks, counted from its corner, and then one: the other deciles are empty.
    Comparison c = compare(image, reference, PixelBounds{4, 3, 20, 11});
    for (size_t k = 0; k < kDeciles; ++k)
        if (k == 4 || k == 9)
            EXPECT_NEAR(c.decile_ratio[k], 3, 1e-6);
        else
            EXPECT_TRUE(std::isnan(c.decile_ratio[k])) << k;
    c = compare(image, reference, PixelBounds{0, 0, 1, 1});
    for (double ratio : c.decile_ratio) EXPECT_TRUE(std::isnan(ratio));
}

TEST(Compare, DecilesOfBlack) {
    Image reference = dark_wall_beside_windows();
    for (Channel& channel : reference.channels)
        for (size_t i = 0; i < channel.values.size(); i += 80)
            std::fill_n(channel.values.begin() + ptrdiff_t(i), 8, 0.0f);
    Image image = reference;
    EXPECT_TRUE(std::isnan(compare(image, reference).decile_ratio[0]));
    EXPECT_EQ(compare(image, reference).decile_ratio[1], 1);
    image.channels[0].values[0] = 1;
    EXPECT_EQ(compare(image, reference).decile_ratio[0], kInf);
}

TEST(Compare, RelmseOfTheMedianKnowsNoExposure) {
    Image reference = dark_wall_beside_windows(), image = reference;
    for (size_t i = 0; i < image.pixel_count(); ++i)
        image.channels[i % 3].values[i] *= 1 + 0.01f * float(i % 17);
    const double expected = compare(image, reference).relmse_median;
    EXPECT_GT(expected, 0);
    for (float factor : {1000.0f, 0.001f}) {
        Image scaled = image, scaled_reference = reference;
        scale(scaled, factor);
        scale(scaled_reference, factor);
        const Comparison c = compare(scaled, scaled_reference);
        EXPECT_NEAR(c.relmse_median, expected, 1e-5 * expected) << factor;
    }
    // The measure is relmse_trimmed where the median is 1.
    scale(image, 1 / 1.4f);
    scale(reference, 1 / 1.4f);
    const Comparison c = compare(image, reference);
    EXPECT_NEAR(c.relmse_median, c.relmse_trimmed, 1e-5 * expected);
    EXPECT_NEAR(c.relmse_median, expected, 1e-5 * expected);
}

TEST(Compare, RelmseOfTheMedianByHand) {
    Image reference = uniform(4, 1, Rgb(0)), image = reference;
    const auto set = [](Image& i, std::array<float, 4> values) {
        for (Channel& channel : i.channels) channel.values.assign(values.begin(), values.end());
    };
    // The exposure is the median, the upper of two; then the mean, where most is black; then 1.
    set(image, {0.5f, 0, 0, 0});
    set(reference, {0, 4, 0, 2});
    const double tenth = 0.2 * 0.2;
    EXPECT_NEAR(compare(image, reference).relmse_median,
                (0.25 / tenth + 16 / (16 + tenth) + 4 / (4 + tenth)) / 4, 1e-6);
    set(reference, {0, 0, 0, 4});
    EXPECT_NEAR(compare(image, reference).relmse_median, (0.25 / 0.01 + 16 / 16.01) / 4, 1e-6);
    set(reference, {0, 0, 0, 8});
    EXPECT_NEAR(compare(image, reference).relmse_median, (0.25 / 0.04 + 64 / 64.04) / 4, 1e-6);
    set(reference, {0, 0, 0, 0});
    EXPECT_NEAR(compare(image, reference).relmse_median, 0.25 / 0.01 / 4, 1e-6);
}

TEST(Compare, RelmseOfTheMedianIsTrimmed) {
    const Image reference = uniform(1000, 1, Rgb(1));
    Image image = reference;
    image.channels[1].values[7] = 1e6f;
    EXPECT_EQ(compare(image, reference).relmse_median, 0);
}

TEST(Compare, IdenticalMeansBitsOfAllLayers) {
    Image a = uniform(2, 2, Rgb(kNan)), b = a;
    EXPECT_TRUE(compare(a, b).identical);  // equal bits, although NaN is not equal to itself
    std::swap(b.channels[0], b.channels[2]);
    EXPECT_TRUE(compare(a, b).identical);  // channels are compared by name, not by order
    b.metadata["seconds"] = 1.0f;
    EXPECT_TRUE(compare(a, b).identical);
    b.add_channel("raw.R");
    EXPECT_FALSE(compare(a, b).identical);
    a.add_channel("raw.R").values[3] = -0.0f;
    EXPECT_FALSE(compare(a, b).identical);
}

TEST(Compare, CropsAndWindows) {
    const Image full = uniform(8, 8, Rgb(1));
    Image part = uniform(4, 4, Rgb(2));
    part.data = {2, 2, 6, 6};
    part.display = full.display;
    EXPECT_EQ(compare(part, full).pixels, 16);
    EXPECT_EQ(compare(full, part).pixels, 16);
    EXPECT_EQ(compare(part, full, PixelBounds{0, 0, 3, 3}).pixels, 1);
    EXPECT_FALSE(compare(part, full).identical);

    Image image = full;
    image.channels[0].values[8 * 3 + 5] = 9;
    image.channels[0].values[0] = kNan;
    const Comparison c = compare(image, full, PixelBounds{5, 3, 6, 4});
    EXPECT_EQ(c.pixels, 1);
    EXPECT_DOUBLE_EQ(c.mse, 64.0 / 3);
    EXPECT_EQ(c.nonfinite, 0);
}

TEST(Compare, RefusesWhatDoesNotFit) {
    const auto message = [](const Image& a, const Image& b, std::optional<PixelBounds> crop = {}) {
        const Error error = error_of([&] { compare(a, b, crop); });
        EXPECT_EQ(error.kind(), ErrorKind::usage);
        return std::string(error.what());
    };
    const Image full = uniform(8, 8, Rgb(1));
    EXPECT_EQ(message(uniform(8, 8, Rgb(1)), uniform(8, 9, Rgb(1))),
              "the images have different sizes: 8x8 and the reference 8x9");
    Image left = uniform(4, 8, Rgb(1)), right = left;
    left.display = right.display = {0, 0, 8, 8};
    left.data = {0, 0, 4, 8};
    right.data = {3, 0, 7, 8};
    EXPECT_NE(message(left, right).find("0,0,4,8"), std::string::npos);
    EXPECT_EQ(compare(left, right, PixelBounds{0, 0, 8, 8}).pixels, 8);
    EXPECT_NE(message(left, right, PixelBounds{5, 0, 8, 8}).find("5,0,8,8"), std::string::npos);
    EXPECT_NE(message(full, full, PixelBounds{8, 8, 9, 9}).find("no pixels"), std::string::npos);
    Image moved = full;
    moved.display = {1, 0, 9, 8};
    EXPECT_NE(message(full, moved).find("display windows"), std::string::npos);
    Image depth{{0, 0, 8, 8}, {0, 0, 8, 8}, {}, {}};
    depth.add_channel("Z");
    EXPECT_NE(message(depth, full).find("the image has no root channels"), std::string::npos);
    EXPECT_NE(message(full, depth).find("the reference has no root"), std::string::npos);
}

TEST(Compare, GreyStandsForAllChannels) {
    Image grey{{0, 0, 2, 2}, {0, 0, 2, 2}, {}, {}};
    grey.add_channel("Y").values.assign(4, 0.5f);
    EXPECT_EQ(compare(grey, uniform(2, 2, Rgb(0.5f))).mse, 0);
}

}  // namespace
}  // namespace covtrace
