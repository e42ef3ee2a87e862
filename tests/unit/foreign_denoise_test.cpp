// Pictures with noise of known distribution: what is reconstructed, what is told of its error, what
// is refused.
#include "foreign/denoise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/error.h"
#include "foreign_fixtures.h"

namespace covtrace {
namespace {

using namespace test;

std::vector<NamedImage> two(const Noise& noise = {}) {
    Noise other = noise;
    other.seed += 100;
    return {{"a.exr", noisy_image(noise)}, {"b.exr", noisy_image(other)}};
}

void remove_channels(Image& image, std::string_view prefix) {
    std::erase_if(image.channels, [&](const Channel& c) { return c.name.starts_with(prefix); });
}

TEST(Denoise, TwoRendersLoseTheirNoiseAndTellTheRest) {
    for (uint64_t seed : {1u, 2u, 3u}) {
        const DenoisedImage d = denoise(two({.seed = seed}));
        // The mean of both has 0.4 / sqrt(2) = 0.28, less in the dark.
        const double error = relative_error(d.image);
        EXPECT_LT(error, 0.07) << seed;
        EXPECT_GT(d.error, error / 1.5) << seed;
        EXPECT_LT(d.error, error * 1.5) << seed;
        EXPECT_TRUE(d.warnings.empty());
    }
}

TEST(Denoise, OneRenderWithItsVarianceDoesSo) {
    for (uint64_t seed : {1u, 2u, 3u}) {
        const DenoisedImage d =
            denoise(std::vector<NamedImage>{{"a", noisy_image({.seed = seed})}});
        const double error = relative_error(d.image);
        EXPECT_LT(error, 0.12) << seed;  // of 0.4
        EXPECT_GT(d.error, error / 1.6) << seed;
        EXPECT_LT(d.error, error * 1.6) << seed;
    }
}

TEST(Denoise, TheErrorLayerIsOfTheLuminance) {
    const DenoisedImage d = denoise(two());
    const Channel& error = *d.image.find("error.Y");
    double told = 0, real = 0;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const size_t i = size_t(y) * kWidth + size_t(x);
            const double t = double(truth(x, y)), e = double(error.values[i]),
                         r = double(luminance(d.image.rgb(i))) - t;
            told += e * e;
            real += r * r;
        }
    EXPECT_GT(told, real / 2.25);
    EXPECT_LT(told, real * 2.25);
}

TEST(Denoise, TextureIsKeptByItsAlbedoAlone) {
    std::vector<NamedImage> images = two(), plain = two();
    for (NamedImage& named : plain)
        for (const char* feature : {"albedo", "N", "Z"}) remove_channels(named.image, feature);
    const DenoisedImage with = denoise(images), without = denoise(plain);
    EXPECT_LT(relative_error(with.image), 0.75 * relative_error(without.image));
    ASSERT_EQ(without.warnings.size(), 1u);
    EXPECT_NE(without.warnings[0].text.find("albedo, normal, depth"), std::string::npos);
}

TEST(Denoise, RawAndVarianceAreOfTheImagesThemselves) {
    const std::vector<NamedImage> images = two({.scale = 1e-5f});
    const Image result = denoise(images).image;
    for (size_t i : {0u, 999u, 6000u}) {
        const auto mean = [&](const char* name) {
            return 0.5f *
                   (images[0].image.find(name)->values[i] + images[1].image.find(name)->values[i]);
        };
        EXPECT_FLOAT_EQ(result.find("raw.G")->values[i], mean("G"));
        // A half of each one's variance, an eighth of which is lent by the pixels around
        EXPECT_NEAR(result.find("variance.G")->values[i] / (0.5f * mean("variance.G")), 1, 0.5);
    }
}

TEST(Denoise, BrightnessDoesNotMatter) {
    const double at_one = relative_error(denoise(two()).image);
    for (float scale : {1e-30f, 1e-6f, 3e4f, 1e6f, 1e30f}) {
        // A picture's variance is far beyond single precision where it is of 1e30 or 1e-30.
        std::vector<NamedImage> images = two({.scale = scale});
        for (NamedImage& named : images) remove_channels(named.image, "variance");
        const DenoisedImage d = denoise(images);
        EXPECT_LT(relative_error(d.image, scale), 1.15 * at_one) << scale;
        EXPECT_GT(d.error, at_one / 1.6) << scale;
        EXPECT_LT(d.error, at_one * 1.6) << scale;
        for (const Channel& c : d.image.channels)
            for (float v : c.values) ASSERT_TRUE(std::isfinite(v)) << scale << c.name;
    }
}

TEST(Denoise, UnitsChangeNoBitButTheExponents) {
    for (float scale : {1e-6f, 1e6f}) {
        const float other = 0x1p-9f * scale;
        const Image a = denoise(two({.scale = scale})).image,
                    b = denoise(two({.scale = scale < 1 ? other : scale * 0x1p9f})).image;
        const float ratio = scale < 1 ? 0x1p-9f : 0x1p9f;
        for (const char* name : {"R", "G", "B", "raw.R", "error.Y"})
            for (size_t i = 0; i < a.pixel_count(); ++i)
                ASSERT_EQ(b.find(name)->values[i], ratio * a.find(name)->values[i]) << name;
    }
}

TEST(Denoise, PixelsBeyondAllLightAreLost) {
    const auto expect_lost = [](float scale, float beyond) {
        std::vector<NamedImage> images = two({.scale = scale});
        images[0].image.channels[1].values[20 * kWidth + 30] = beyond;
        images[0].image.channels[4].values[20 * kWidth + 30] = 3e38f;  // its variance
        const DenoisedImage d = denoise(images);
        for (const Channel& c : d.image.channels)
            for (float v : c.values)
                ASSERT_LT(std::abs(v), 1e3f * scale * std::max(1.0f, scale)) << c.name;
        EXPECT_LT(relative_error(d.image, scale), 0.08) << scale;
        ASSERT_EQ(d.warnings.size(), 1u);
        EXPECT_NE(d.warnings[0].text.find("1 pixel is not finite, or beyond all light"),
                  std::string::npos);
        images.pop_back();
        EXPECT_LT(relative_error(denoise(images).image, scale), 0.13) << scale;
    };
    expect_lost(1e-6f, 1e33f);
    expect_lost(1, -1e33f);
    expect_lost(1e6f, 3e38f);
}

TEST(Denoise, LostPixelsAreFilled) {
    std::vector<NamedImage> images = two();
    for (size_t k : {0u, 1u}) {
        images[k].image.channels[0].values[500 + k] = std::numeric_limits<float>::quiet_NaN();
        images[k].image.channels[2].values[2000] = -std::numeric_limits<float>::infinity();
    }
    const DenoisedImage d = denoise(images);
    for (const Channel& c : d.image.channels)
        for (float v : c.values) ASSERT_TRUE(std::isfinite(v)) << c.name;
    EXPECT_LT(relative_error(d.image), 0.08);
    ASSERT_EQ(d.warnings.size(), 1u);
    EXPECT_EQ(d.warnings[0].text, "3 pixels are not finite, or beyond all light: lost samples");
}

TEST(Denoise, KeepsWindowsAlphaAndCamera) {
    std::vector<NamedImage> images = two();
    for (size_t k : {0u, 1u}) {
        Image& image = images[k].image;
        image.display = {-4, 0, kWidth + 10, kHeight};
        image.add_channel("A").values.assign(image.pixel_count(), k == 0 ? 1 : 0.5f);
        image.metadata["worldToCamera"] = std::vector<float>(16, 1);
        image.metadata["samplesPerPixel"] = 4;
        image.metadata["pixelAspectRatio"] = 2.0f;
        image.metadata["renderTimeSeconds"] = 3.0f;
    }
    const Image result = denoise(images).image;
    EXPECT_EQ(result.display, images[0].image.display);
    EXPECT_EQ(result.find("A")->values[7], 0.75f);
    EXPECT_TRUE(result.metadata.contains("worldToCamera"));
    EXPECT_EQ(std::get<float>(result.metadata.at("pixelAspectRatio")), 2);
    EXPECT_FALSE(result.metadata.contains("renderTimeSeconds"));
    EXPECT_EQ(std::get<float>(result.metadata.at("spp")), 8);
}

/// Blends every pixel with those to its left and above, as a filter does that splats samples.
void splat(Image& image) {
    for (size_t k = 0; k < 3; ++k) {
        const std::vector<float> sharp = image.channels[k].values;
        for (size_t y = 1; y < kHeight; ++y)
            for (size_t x = 1; x < kWidth; ++x) {
                const size_t i = y * kWidth + x;
                image.channels[k].values[i] =
                    0.25f * (sharp[i] + sharp[i - 1] + sharp[i - kWidth] + sharp[i - kWidth - 1]);
            }
    }
}

/// Leaves images as they are, and notes their width.
class WidthDenoiser : public Denoiser {
  public:
    std::string name() const override { return "width"; }
    size_t memory(size_t) const override { return 0; }
    std::vector<ColorPlanes> denoise(const NoisyFeatures&,
                                     std::vector<NoisyImage> images) const override {
        width = images[0].color[0].width;
        std::vector<ColorPlanes> results;
        for (NoisyImage& image : images) results.push_back(std::move(image.color));
        return results;
    }
    mutable int width = 0;
};

TEST(Denoise, ADenoiserSeesPixelsWithNoiseOfTheirOwn) {
    std::vector<NamedImage> images = two();
    const WidthDenoiser denoiser;
    denoise(images, {.denoiser = &denoiser});
    EXPECT_EQ(denoiser.width, kWidth);
    for (NamedImage& named : images) splat(named.image);
    denoise(images, {.denoiser = &denoiser});
    EXPECT_EQ(denoiser.width, kWidth / 2);
}

TEST(Denoise, OneRendersBrightPathLeavesNoBlot) {
    std::vector<NamedImage> images = two();
    const double without = relative_error(denoise(images).image);
    for (size_t k = 0; k < 3; ++k) images[0].image.channels[k].values[20 * kWidth + 30] = 3000;
    EXPECT_LT(relative_error(denoise(images).image), 1.2 * without);
}

std::string message_of(const std::vector<NamedImage>& images, const DenoiseOptions& options = {}) {
    try {
        denoise(images, options);
    } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::usage);
        return e.what();
    }
    return "";
}

TEST(Denoise, LeavesBlackFramesBlack) {
    const std::vector<NamedImage> black{{"a.exr", image_with({"R", "G", "B"}, 32, 24)},
                                        {"b.exr", image_with({"R", "G", "B"}, 32, 24)}};
    for (const Channel& c : denoise(black).image.channels)
        for (const float v : c.values) EXPECT_EQ(v, 0) << c.name;
}

TEST(Denoise, RefusesWhatCannotTellItsNoise) {
    std::vector<NamedImage> one{{"a.exr", noisy_image({})}};
    std::vector<NamedImage> same{{"a.exr", noisy_image({})}, {"b.exr", noisy_image({})}};
    EXPECT_NE(message_of(same).find("b.exr has the same pixels as a.exr"), std::string::npos);
    remove_channels(one[0].image, "variance");
    EXPECT_NE(message_of(one).find("a.exr has no variance; expected a second render"),
              std::string::npos);
    one[0].image = noisy_image({.relative = 0});
    EXPECT_NE(message_of(one).find("a.exr has a variance of 0"), std::string::npos);
    EXPECT_NE(message_of({}), "");
    std::vector<NamedImage> lost = two();
    for (float& v : lost[1].image.channels[0].values) v = std::numeric_limits<float>::infinity();
    EXPECT_EQ(message_of(lost), "b.exr has no pixel that is finite");
    std::vector<NamedImage> sizes{{"a.exr", noisy_image({})},
                                  {"b.exr", image_with({"R", "G", "B"})}};
    EXPECT_EQ(message_of(sizes),
              "b.exr: expected another render of the picture of a.exr, but it has 4x3 pixels, that "
              "has 96x64");
    std::vector<NamedImage> moved = two();
    moved[1].image.data = {1, 0, kWidth + 1, kHeight};
    EXPECT_NE(message_of(moved).find("different places"), std::string::npos);
}

}  // namespace
}  // namespace covtrace
