#include "texture/image.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <numeric>

#include "core/rng.h"
#include "image/color_encoding.h"
#include "texture_fixtures.h"

namespace covtrace {
namespace {

using Encoding = TextureImage::Encoding;
using Wrap = TextureImage::Wrap;

RasterImage raster(int width, int height, int channels, const std::vector<float>& values,
                   bool is_8bit = false) {
    RasterImage r;
    r.width = width;
    r.height = height;
    r.channels = channels;
    r.is_8bit = is_8bit;
    for (const float v : values) add_value(r, v);
    return r;
}

/// 3 x 2 grey texels 1 2 3 / 4 5 6.
TextureImage numbered(Wrap wrap) {
    return {raster(3, 2, 1, {1, 2, 3, 4, 5, 6}), Encoding::linear, 1, wrap};
}

float nearest(const TextureImage& image, float s, float t) {
    return image.value(image.nearest({s, t}));
}
float bilinear(const TextureImage& image, float s, float t) {
    return image.value(image.bilinear({s, t}));
}

TEST(TextureImage, InterpolatesBetweenTexelCentres) {
    const TextureImage image = numbered(Wrap::clamp);
    EXPECT_FLOAT_EQ(bilinear(image, 0.5f / 3, 0.25f), 1);
    EXPECT_FLOAT_EQ(bilinear(image, 1.5f / 3, 0.75f), 5);
    EXPECT_FLOAT_EQ(bilinear(image, 1.0f / 3, 0.25f), 1.5f);
    EXPECT_FLOAT_EQ(bilinear(image, 0.5f, 0.5f), 3.5f);
    EXPECT_FLOAT_EQ(nearest(image, 0.34f, 0.1f), 2);
    EXPECT_FLOAT_EQ(nearest(image, 0.32f, 0.9f), 4);
}

TEST(TextureImage, RepeatsInBothDirections) {
    const TextureImage image = numbered(Wrap::repeat);
    for (const float shift : {-3.0f, -1.0f, 1.0f, 7.0f}) {
        EXPECT_NEAR(bilinear(image, 0.4f + shift, 0.3f), bilinear(image, 0.4f, 0.3f), 1e-5);
        EXPECT_NEAR(bilinear(image, 0.4f, 0.3f + shift), bilinear(image, 0.4f, 0.3f), 1e-5);
        EXPECT_FLOAT_EQ(nearest(image, 0.9f + shift, 0.3f + shift), 3);
    }
    EXPECT_FLOAT_EQ(bilinear(image, 0, 0.25f), 2);  // between the last and the first column
    EXPECT_FLOAT_EQ(bilinear(image, 0.5f / 3, 0), 2.5f);
}

TEST(TextureImage, ClampsToTheBorder) {
    const TextureImage image = numbered(Wrap::clamp);
    EXPECT_FLOAT_EQ(bilinear(image, -5, -5), 1);
    EXPECT_FLOAT_EQ(bilinear(image, 5, 0.75f), 6);
    EXPECT_FLOAT_EQ(bilinear(image, 0, 0.25f), 1);
    EXPECT_FLOAT_EQ(nearest(image, 1, 1), 6);
}

TEST(TextureImage, IsBlackOutsideWhereAsked) {
    const TextureImage image = numbered(Wrap::black);
    EXPECT_FLOAT_EQ(bilinear(image, -5, 0.5f), 0);
    EXPECT_FLOAT_EQ(nearest(image, 1.01f, 0.5f), 0);
    EXPECT_FLOAT_EQ(bilinear(image, 0, 0.25f), 0.5f);
    EXPECT_FLOAT_EQ(bilinear(image, 0.5f / 3, 0.25f), 1);
}

TEST(TextureImage, WrapsEachAxisInItsOwnWay) {
    // The texels are products f(s) g(t), which are interpolated each for itself.
    const auto product = [](TextureImage::Wraps wraps) {
        return TextureImage(raster(3, 2, 1, {1, 2, 3, 10, 20, 30}), Encoding::linear, 1, wraps);
    };
    const Wrap all[] = {Wrap::repeat, Wrap::black, Wrap::clamp, Wrap::mirror};
    const float places[] = {-2.2f, -0.9f, -0.1f, 0.05f, 0.6f, 1.05f, 1.4f, 2.7f};
    for (const Wrap in_s : all)
        for (const Wrap in_t : all) {
            const TextureImage mixed = product({in_s, in_t}), f = product(in_s), g = product(in_t);
            for (const float s : places)
                for (const float t : places) {
                    EXPECT_NEAR(bilinear(mixed, s, t),
                                bilinear(f, s, 0.25f) * bilinear(g, 0.5f / 3, t), 1e-4f);
                    EXPECT_EQ(nearest(mixed, s, t), nearest(f, s, 0.25f) * nearest(g, 0.1f, t));
                }
        }
}

TEST(TextureImage, ContinuesAcrossTheBordersOfAnOctahedralMap) {
    std::vector<float> values(16);
    std::iota(values.begin(), values.end(), 0.0f);
    const TextureImage image(raster(4, 4, 1, values), Encoding::linear, 1, Wrap::octahedral_sphere);
    const auto texel = [&](int x, int y) {
        return nearest(image, (float(x) + 0.5f) / 4, (float(y) + 0.5f) / 4);
    };
    EXPECT_FLOAT_EQ(texel(1, 2), 9);
    for (int i = 0; i < 4; ++i) {
        EXPECT_FLOAT_EQ(texel(-1, i), texel(0, 3 - i));
        EXPECT_FLOAT_EQ(texel(4, i), texel(3, 3 - i));
        EXPECT_FLOAT_EQ(texel(i, -1), texel(3 - i, 0));
        EXPECT_FLOAT_EQ(texel(i, 4), texel(3 - i, 3));
    }
}

TEST(TextureImage, DecodesEightBitsByTableAndOthersOnce) {
    std::vector<float> values;
    for (int i = 0; i < 256; ++i) values.push_back(float(i) / 255);
    for (const bool is_8bit : {true, false}) {
        const RasterImage r = raster(256, 1, 1, values, is_8bit);
        const TextureImage srgb(r, Encoding::srgb, 1, Wrap::clamp);
        const TextureImage linear(r, Encoding::linear, 1, Wrap::clamp);
        const TextureImage gamma(r, Encoding::gamma, 1.8f, Wrap::clamp);
        for (size_t i = 0; i < 256; ++i) {
            EXPECT_FLOAT_EQ(srgb.value(i), srgb_decode(values[i]));
            EXPECT_FLOAT_EQ(linear.value(i), values[i]);
            EXPECT_FLOAT_EQ(gamma.value(i), std::pow(values[i], 1.8f));
        }
        EXPECT_EQ(srgb.memory(), is_8bit ? size_t(256) : 256 * sizeof(float));
    }
}

TEST(TextureImage, CoarserLevelsOfBytesAreThoseNearestToTheMean) {
    constexpr int kBlocks = 96;
    Rng rng(3);
    RasterImage bytes = raster(2 * kBlocks, 2 * kBlocks, 1, {}, true);
    for (int i = 0; i < 4 * kBlocks * kBlocks; ++i)
        bytes.bytes.push_back(uint8_t(256 * rng.next_float()));
    const auto gammas = {1.0f, 0.1f, 2.2f, 9.0f};
    for (const Encoding encoding : {Encoding::linear, Encoding::srgb, Encoding::gamma})
        for (const float gamma : gammas) {
            std::vector<float> every(256);
            for (size_t i = 0; i < 256; ++i) every[i] = float(i) / 255;
            const TextureImage table(raster(256, 1, 1, every, true), encoding, gamma, Wrap::clamp);
            TextureImage image(bytes, encoding, gamma, Wrap::clamp);
            image.build_levels();
            for (int y = 0; y < kBlocks; ++y)
                for (int x = 0; x < kBlocks; ++x) {
                    float mean = 0;
                    for (const auto& [dx, dy] : {std::pair{0, 0}, {1, 0}, {0, 1}, {1, 1}})
                        mean +=
                            image.value(size_t(2 * y + dy) * 2 * kBlocks + size_t(2 * x + dx)) / 4;
                    float least = kInfinity;
                    for (size_t i = 0; i < 256; ++i)
                        least = std::min(least, std::abs(table.value(i) - mean));
                    const Vec2 st{(float(x) + 0.5f) / kBlocks, (float(y) + 0.5f) / kBlocks};
                    ASSERT_NEAR(std::abs(image.value(image.nearest(st, 1)) - mean), least, 1e-7f);
                }
            if (encoding != Encoding::gamma) break;  // the others have none
        }
}

TEST(TextureImage, FloatValueIsTheMeanOrAMeaningfulAlpha) {
    const auto image = [](std::vector<float> values) {
        return TextureImage(raster(2, 1, 4, std::move(values)), Encoding::linear, 1, Wrap::clamp);
    };
    const TextureImage opaque = image({0.1f, 0.2f, 0.6f, 1, 0, 0, 0, 1});
    EXPECT_FLOAT_EQ(opaque.value(0), 0.3f);
    EXPECT_EQ(opaque.memory(), 6 * sizeof(float));
    const TextureImage cutout = image({0.1f, 0.2f, 0.6f, 1, 0, 0, 0, 0.25f});
    EXPECT_FLOAT_EQ(cutout.value(0), 1);
    EXPECT_FLOAT_EQ(cutout.value(1), 0.25f);
    EXPECT_EQ(cutout.color(0), Rgb(0.1f, 0.2f, 0.6f));
}

RC_GTEST_PROP(TextureImage, IsAMeanOfTexelsAtAnyCoordinates, ()) {
    const auto wrap =
        *rc::gen::element(Wrap::repeat, Wrap::black, Wrap::clamp, Wrap::octahedral_sphere);
    const int width = *rc::gen::inRange(1, 5), height = *rc::gen::inRange(1, 5);
    const TextureImage image(
        raster(width, height, 1, std::vector<float>(size_t(width * height), 2.0f)),
        Encoding::linear, 1, wrap);
    const auto coordinate = rc::gen::oneOf(
        rc::gen::map(rc::gen::inRange(-4000, 4000), [](int i) { return float(i) / 1000; }),
        rc::gen::element(kInfinity, -kInfinity, std::nanf(""), 1e30f, -1e-30f, 16777217.0f));
    const Vec2 st{*coordinate, *coordinate};
    for (const auto& taps : {image.nearest(st), image.bilinear(st)}) {
        float weights = 0;
        for (size_t i = 0; i < size_t(taps.count); ++i) {
            RC_ASSERT(taps.texel[i] < size_t(width * height));
            RC_ASSERT(taps.weight[i] >= 0);
            weights += taps.weight[i];
        }
        RC_ASSERT(weights <= 1.00001f);
        if (wrap != Wrap::black) RC_ASSERT(weights > 0.99999f);
        RC_ASSERT(std::abs(image.value(taps) - 2 * weights) < 1e-5f);
    }
}

}  // namespace
}  // namespace covtrace
