// Halves of images: lost samples, variances, and the halves that are made of one image.
#include "foreign/image_halves.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "foreign_fixtures.h"

namespace covtrace {
namespace {

using namespace test;

SampledImage sampled(const Image& image, float samples = 8) {
    return {image, find_layers(image, {}, "a"), samples};
}

TEST(ImageHalves, OfTwoImagesAreTheirPixels) {
    const Image a = noisy_image({.seed = 1}), b = noisy_image({.seed = 2});
    const ImageHalves made = halves_of_two(sampled(a), sampled(b, 4));
    EXPECT_EQ(made.lost, 0);
    EXPECT_TRUE(made.are_samples_known);
    for (size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(made.halves[0].color[k].values, a.channels[k].values);
        EXPECT_EQ(made.halves[1].color[k].values, b.channels[k].values);
        EXPECT_EQ(made.halves[0].feature[k].values, a.channels[6 + k].values);
        EXPECT_EQ(made.halves[1].feature[3 + k].values, b.channels[9 + k].values);
    }
    EXPECT_FLOAT_EQ(made.halves[0].feature[6][0], std::log(5.0f));
    EXPECT_EQ(made.halves[0].count[0], 8);
    EXPECT_EQ(made.halves[1].count[0], 4);
}

TEST(ImageHalves, HaveNoSamplesWherePixelsAreNotFinite) {
    Image a = noisy_image({.seed = 1});
    const Image b = noisy_image({.seed = 2});
    a.channels[1].values[17] = std::numeric_limits<float>::quiet_NaN();
    a.channels[9].values[40] = std::numeric_limits<float>::infinity();
    a.channels[12].values[41] = std::numeric_limits<float>::infinity();  // only the background
    const ImageHalves made = halves_of_two(sampled(a), sampled(b));
    EXPECT_EQ(made.lost, 2);
    EXPECT_EQ(made.halves[0].count[17], 0);
    EXPECT_EQ(made.halves[0].count[40], 0);
    EXPECT_EQ(made.halves[0].count[41], 8);
    EXPECT_EQ(made.halves[0].feature[6][41], 0);
    EXPECT_NEAR(made.halves[0].color[1][17], truth(17, 0), 0.5f);  // filled from around
}

TEST(ImageHalves, LoneNegativePixelsAreTheOthers) {
    Image a = image_with({"R", "G", "B"}, 24, 8), b = a;
    for (Image* image : {&a, &b})
        for (Channel& c : image->channels) c.values.assign(c.values.size(), 0.5f);
    const auto set = [](Image& image, size_t i, float value) {
        for (Channel& c : image.channels) c.values[i] = value;
    };
    const size_t row = 3 * 24, lone = row + 3, both = row + 9, lobe = row + 16;
    set(a, lone, -0.4f);
    set(a, both, -1), set(b, both, -0.1f);  // both saw that it is dark here
    set(a, lobe, -1), set(a, lobe + 2, 8);  // beside a bright pixel
    const ImageHalves made = halves_of_two(sampled(a), sampled(b));
    EXPECT_EQ(made.lost, 0);
    EXPECT_EQ(made.halves[0].count[lone], 0);
    EXPECT_EQ(made.halves[0].color[1][lone], 0.5f);
    for (const size_t i : {both, lobe}) {
        EXPECT_EQ(made.halves[0].count[i], 8) << i;
        EXPECT_EQ(made.halves[0].color[1][i], -1) << i;
    }
    EXPECT_EQ(made.halves[1].color[1][both], -0.1f);
}

TEST(ImageHalves, TakeTheVarianceThatTheDifferenceSuggests) {
    Image a = noisy_image({.seed = 1}), b = noisy_image({.seed = 2});
    for (Image* image : {&a, &b})
        image->channels.erase(image->channels.begin() + 3, image->channels.begin() + 6);
    const ImageHalves made = halves_of_two(sampled(a), sampled(b));
    // A flat part of the wall; 169 pixels around it tell its variance within 40 %, four deviations.
    const float deviation = 0.4f * truth(48, 16);
    EXPECT_NEAR(made.halves[0].color_variance[0](48, 16) / (deviation * deviation), 1, 0.45);
}

TEST(ImageHalves, CyclesTellsShares) {
    Image image = noisy_image({});
    image.add_channel("samples.Y").values.assign(image.pixel_count(), 0.5f);
    image.metadata["cycles.ViewLayer.samples"] = std::string("64");
    const FoundLayers layers = find_layers(image, {}, "a");
    EXPECT_EQ(halves_of_two({image, layers, {}}, {image, layers, {}}).halves[0].count[7], 32);
}

TEST(ImageHalves, PbrtsVarianceIsOfASample) {
    Image image = noisy_image({});
    SampledImage s = sampled(image, 16);
    s.layers.is_variance_of_one = true;
    const ImageHalves of_sample = halves_of_one(s), of_mean = halves_of_one(sampled(image, 16));
    for (size_t i : {0u, 100u, 4000u})
        EXPECT_NEAR(of_sample.halves[0].color_variance[0][i] * 16,
                    of_mean.halves[0].color_variance[0][i], 1e-6f);
}

TEST(ImageHalves, OfOneImageHaveTheNoiseOfRealHalves) {
    const Image image = noisy_image({.seed = 5});
    const ImageHalves made = halves_of_one(sampled(image));
    double aa = 0, bb = 0, ab = 0;
    const auto n = double(image.pixel_count());
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const float a = made.halves[0].color[0](x, y), b = made.halves[1].color[0](x, y);
            EXPECT_NEAR(0.5f * (a + b), image.channels[0].values[size_t(y) * kWidth + size_t(x)],
                        1e-5f);
            const double deviation = double(0.4f * truth(x, y));
            const double ea = double(a - truth(x, y)) / deviation,
                         eb = double(b - truth(x, y)) / deviation;
            aa += ea * ea / n;
            bb += eb * eb / n;
            ab += ea * eb / n;
        }
    // The deviation of aa and bb is 2 sqrt(2/n) = 0.036, that of ab 2 / sqrt(n) = 0.026: bounds of
    // four and more. The pooled variance adds up to 0.1 at edges of the texture.
    EXPECT_NEAR(aa, 2, 0.25);
    EXPECT_NEAR(bb, 2, 0.25);
    EXPECT_NEAR(ab, 0, 0.2);
    EXPECT_EQ(made.halves[0].count[0], 4);
}

TEST(ImageHalves, OneBrightPathIsOfOneHalf) {
    // Alone in its pixel, of 64 samples: its variance is its square. With normal
    // numbers in place of signs no two of the 40 pixels would be alike.
    Image image = image_with({"R", "G", "B", "variance.R", "variance.G", "variance.B"}, 80, 80);
    for (size_t k = 0; k < 40; ++k)
        for (size_t c = 0; c < 3; ++c) {
            image.channels[c].values[161 * k + 50] = 100;
            image.channels[3 + c].values[161 * k + 50] = 1e4f;
        }
    const ImageHalves made = halves_of_one(sampled(image, 64));
    int of_first = 0;
    for (size_t k = 0; k < 40; ++k) {
        const float a = made.halves[0].color[1][161 * k + 50],
                    b = made.halves[1].color[1][161 * k + 50];
        EXPECT_NEAR(std::max(a, b), 200, 2) << k;
        EXPECT_NEAR(std::min(a, b), 0, 2) << k;
        of_first += a > b;
    }
    EXPECT_NEAR(of_first, 20, 16);  // beyond once in 10^7 seeds
}

}  // namespace
}  // namespace covtrace
