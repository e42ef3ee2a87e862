// The owner of a pixel: our own mixture or the denoiser.
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/vec.h"
#include "reconstruction/hybrid.h"
#include "reconstruction_images.h"

namespace covtrace {
namespace {

using namespace test;

/// A denoiser that makes the same of every image, whatever it is.
class FixedDenoiser : public Denoiser {
  public:
    explicit FixedDenoiser(ColorPlanes result) : result_(std::move(result)) {}
    std::string name() const override { return "fixed"; }
    size_t memory(size_t) const override { return 0; }
    std::vector<ColorPlanes> denoise(const NoisyFeatures&,
                                     std::vector<NoisyImage> images) const override {
        return std::vector<ColorPlanes>(images.size(), result_);
    }

  private:
    ColorPlanes result_;
};

class FailingDenoiser : public FixedDenoiser {
  public:
    FailingDenoiser() : FixedDenoiser(constant(0)) {}
    std::vector<ColorPlanes> denoise(const NoisyFeatures&, std::vector<NoisyImage>) const override {
        throw Error(ErrorKind::limit, "out of order");
    }
};

/// A denoiser that remembers the features of its last images.
class AskedDenoiser : public FixedDenoiser {
  public:
    AskedDenoiser() : FixedDenoiser(constant(1)) {}
    std::vector<ColorPlanes> denoise(const NoisyFeatures& features,
                                     std::vector<NoisyImage> images) const override {
        seen = features;
        images_seen = images.size();
        return FixedDenoiser::denoise(features, std::move(images));
    }
    mutable NoisyFeatures seen;
    mutable size_t images_seen = 0;
};

ColorPlanes grey(const auto& truth) {
    ColorPlanes color = constant(0);
    for (Plane& p : color)
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x) p(x, y) = truth(x, y);
    return color;
}

HybridImage with(const Denoiser& denoiser, const Halves& halves,
                 DenoiserQuality quality = DenoiserQuality::high) {
    HybridSettings settings;
    settings.denoiser = &denoiser;
    settings.quality = quality;
    return reconstruct(halves, kSpectrum, settings);
}

double mean_share(const HybridImage& image) {
    double sum = 0;
    for (float v : image.share.back().values) sum += double(v);
    return sum / (kSize * kSize);
}

TEST(DenoiserBlend, ADenoiserThatIsRightGetsMost) {
    const Halves halves = noisy_halves(kSize, kSize, checks, 0.3f, 31);
    const HybridImage image = with(FixedDenoiser(grey(checks)), halves);
    EXPECT_GT(mean_share(image), 0.75);
    EXPECT_LT(mean_squared_error(image.color, checks),
              0.1 * mean_squared_error(reconstruct(halves, kSpectrum).color, checks));
}

TEST(DenoiserBlend, ADenoiserThatIsWrongGetsNothingWhereSamplesCanTell) {
    const Halves halves = noisy_halves(kSize, kSize, smooth_truth, 0.02f, 32);
    const HybridImage image = with(FixedDenoiser(constant(0.5f)), halves);
    EXPECT_LT(mean_share(image), 0.02);
    EXPECT_LT(mean_squared_error(image.color, smooth_truth),
              2 * mean_squared_error(reconstruct(halves, kSpectrum).color, smooth_truth));
}

TEST(DenoiserBlend, NoiseThatTellsNothingLeavesThePriorShare) {
    // The denoiser is off by a hundredth, the noise of the samples is a hundred times as much.
    const auto one = [](int, int) { return 1.0f; };
    const Halves halves = noisy_halves(kSize, kSize, one, 1, 33);
    const double share = mean_share(with(FixedDenoiser(constant(1.01f)), halves));
    EXPECT_GT(share, 0.6);
    EXPECT_LT(share, 1);
}

TEST(DenoiserBlend, RareLightIsTheDenoisers) {
    // One pixel in 200 has all of the light that our own limit takes away. Noise that lets nothing
    // be judged does not give it back to us.
    for (const float variance : {2500.0f, 2.5e5f}) {
        Halves halves = noisy_halves(
            kSize, kSize, [](int, int) { return 0.5f; }, 0.05f, 34);
        for (HalfBuffer& half : halves)
            for (size_t c = 0; c < 3; ++c)
                for (size_t i = &half == &halves[0] ? 0u : 100u; i < half.color[c].size();
                     i += 200) {
                    half.color[c][i] += 100;
                    half.color_variance[c][i] = variance;
                }
        EXPECT_GT(mean_share(with(FixedDenoiser(constant(1)), halves)), 0.95);
    }
}

TEST(DenoiserBlend, AFewPixelsThatMissedTheLightAreTheDenoisers) {
    // Half of all samples meet the light, and 3 x 3 pixels that all missed it know no better.
    Halves halves = noisy_halves(
        kSize, kSize, [](int, int) { return 0.0f; }, 0, 38);
    Rng rng(39);
    for (HalfBuffer& half : halves)
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x) {
                half.count(x, y) = 3;
                const bool missed = std::abs(x - 32) <= 1 && std::abs(y - 32) <= 1;
                float lit = 0;
                for (int i = 0; i < 3; ++i) lit += float(rng.next_float() < 0.5f);
                const bool differ = !missed && lit != 0 && lit != 3;
                for (size_t c = 0; c < 3; ++c) {
                    half.color[c](x, y) = missed ? 0.02f : 2 * lit / 3;
                    half.color_variance[c](x, y) = differ ? 0.5f : 0.2f;
                }
            }
    const HybridImage image = with(FixedDenoiser(constant(1)), halves);
    EXPECT_GT(image.share.back()(32, 32), 0.6f);
    EXPECT_GT(image.color[1](32, 32), 0.6f);
}

TEST(DenoiserBlend, OneSamplePerPixelIsTheDenoisers) {
    // Every pixel has a sample of one half, which sees either of two surfaces.
    Halves halves = noisy_halves(kSize, kSize, smooth_truth, 0.2f, 40);
    ColorPlanes surface = constant(0);
    Rng rng(41);
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
            const size_t half = size_t(x + y) % 2;
            halves[1 - half].count(x, y) = 0;
            for (size_t c = 0; c < 3; ++c)
                halves[half].feature[c](x, y) = surface[c](x, y) =
                    rng.next_float() < 0.5f ? 1.0f : 0.0f;
        }
    const AskedDenoiser denoiser;
    const HybridImage image = with(denoiser, halves);
    // Its features are those of the sample, not half of them those of the holes' surroundings, and
    // no half can judge it by the other one.
    for (size_t c = 0; c < 3; ++c) EXPECT_EQ(denoiser.seen.albedo[c].values, surface[c].values);
    for (const float share : image.share.back().values) ASSERT_EQ(share, 1);
}

/// Halves of a smooth image with as many samples in every pixel of each.
Halves halves_of_samples(float of_each) {
    Halves halves = noisy_halves(kSize, kSize, smooth_truth, 0.2f, 45);
    for (HalfBuffer& half : halves) half.count = Plane(kSize, kSize, of_each);
    return halves;
}

TEST(DenoiserBlend, UpToFourSamplesTheImageIsTheDenoisersAlone) {
    const AskedDenoiser denoiser;
    const HybridImage four = with(denoiser, halves_of_samples(2));
    EXPECT_EQ(denoiser.images_seen, 2u);  // all samples in two sights, and no half
    EXPECT_EQ(mean_share(four), 1);
    const HybridImage six = with(denoiser, halves_of_samples(3));
    EXPECT_EQ(denoiser.images_seen, 4u);
    EXPECT_EQ(six.share.size(), four.share.size());
    EXPECT_LT(mean_share(six), 1);
    // The samples of other renderers are not counted
    HybridSettings settings;
    settings.denoiser = &denoiser;
    settings.noise = HalvesNoise::independent;
    EXPECT_LT(mean_share(reconstruct(halves_of_samples(2), kSpectrum, settings)), 1);
}

TEST(DenoiserBlend, FewSamplesTellTheirErrorByTheSights) {
    class SightsDiffer : public FixedDenoiser {
      public:
        SightsDiffer() : FixedDenoiser(constant(1)) {}
        std::vector<ColorPlanes> denoise(const NoisyFeatures&,
                                         std::vector<NoisyImage> images) const override {
            std::vector<ColorPlanes> results;
            for (const NoisyImage& image : images)
                results.push_back(constant(image.turned ? 1.02f : 0.98f));
            return results;
        }
    };
    const auto one = [](int, int) { return 1.0f; };
    Halves halves = noisy_halves(kSize, kSize, one, 0, 46);
    for (const float count : {0.5f, 2.0f}) {
        for (HalfBuffer& half : halves) half.count = Plane(kSize, kSize, count);
        const HybridImage image = with(SightsDiffer(), halves);
        const float squared = kFewDenoisedError.sights * sqr(0.02f);
        EXPECT_NEAR(image.variance(20, 20), squared, 0.02f * squared);
        EXPECT_NEAR(image.relative_error(20, 20), squared / 1.01f, 0.02f * squared);
    }
}

TEST(DenoiserBlend, FeaturesOfFewSamplesAreNoDraft) {
    const AskedDenoiser denoiser;
    Halves halves = noisy_halves(kSize, kSize, smooth_truth, 0.2f, 36);  // 8 samples in each half
    with(denoiser, halves);
    EXPECT_EQ(denoiser.seen.cleaning, FeatureCleaning::draft);
    halves[0].count = Plane(kSize, kSize, 7);
    with(denoiser, halves);
    EXPECT_EQ(denoiser.seen.cleaning, FeatureCleaning::thorough);
    // The samples of other renderers are not counted
    HybridSettings settings;
    settings.denoiser = &denoiser;
    settings.noise = HalvesNoise::independent;
    reconstruct(halves, kSpectrum, settings);
    EXPECT_EQ(denoiser.seen.cleaning, FeatureCleaning::draft);
}

TEST(DenoiserBlend, BelowThePilotItIsToldOfSamplesByTheirNumber) {
    // Two samples of 0 in one half, one of 1 in the other; with more, one half has planned the
    // other's number, and the halves count alike.
    const AskedDenoiser denoiser;
    Halves halves{HalfBuffer(kSize, kSize), HalfBuffer(kSize, kSize)};
    for (const float times : {1.0f, 4.0f}) {
        halves[0].count = Plane(kSize, kSize, 2 * times);
        halves[1].count = Plane(kSize, kSize, 1 * times);
        for (size_t c = 0; c < 3; ++c) halves[1].feature[c] = Plane(kSize, kSize, 1);
        with(denoiser, halves);
        EXPECT_FLOAT_EQ(denoiser.seen.albedo[0][0], times == 1 ? 1.0f / 3 : 0.5f);
    }
}

TEST(DenoiserBlend, FewSamplesKeepLessOfRareLight) {
    // The denoiser leaves out what four pixels alone have seen, as a network does. Of 16 samples
    // nearly all of that light comes back, of 4 a fourth, of 2 nothing.
    constexpr float kLight = 60;
    const auto light_of = [&](float samples_of_half) {
        Halves halves = noisy_halves(
            kSize, kSize, [](int, int) { return 1.0f; }, 0, 37);
        for (HalfBuffer& half : halves) {
            half.count = Plane(kSize, kSize, samples_of_half);
            for (size_t c = 0; c < 3; ++c)
                for (const int x : {kSize / 4, 3 * kSize / 4})
                    half.color[c](x, &half == &halves[0] ? 16 : 48) += 2 * kLight;
        }
        for (const int x : {kSize / 4, 3 * kSize / 4})
            for (size_t c = 0; c < 3; ++c) {
                halves[0].color_variance[c](x, 16) = 4 * sqr(kLight);
                halves[1].color_variance[c](x, 48) = 4 * sqr(kLight);
            }
        return mean_of(with(FixedDenoiser(constant(1)), halves).color) - 1;
    };
    constexpr double kAll = 4 * kLight / (kSize * kSize);
    EXPECT_GT(light_of(8), 0.9 * kAll);
    EXPECT_LT(light_of(2), 0.5 * kAll);
    EXPECT_LT(light_of(1), 0.05 * kAll);
}

TEST(DenoiserBlend, FastQualityIsTheDenoisersAlone) {
    // Even one that is wrong: nothing of our own is there to tell.
    const Halves halves = noisy_halves(kSize, kSize, smooth_truth, 0.02f, 42);
    const AskedDenoiser denoiser;
    const HybridImage image = with(denoiser, halves, DenoiserQuality::fast);
    EXPECT_EQ(denoiser.images_seen, 2u);
    EXPECT_EQ(denoiser.seen.cleaning, FeatureCleaning::none);
    ASSERT_EQ(image.share.size(), reconstruct(halves, kSpectrum).share.size() + 1);
    EXPECT_EQ(mean_share(image), 1);
    for (size_t c = 0; c + 1 < image.share.size(); ++c)
        for (const float share : image.share[c].values) ASSERT_EQ(share, 0);
    const Plane& color = image.color[0];
    const float scale = color(5, 5);
    for (const float v : color.values) EXPECT_NEAR(v, scale, 0.5f * scale);
}

TEST(DenoiserBlend, FastQualityKeepsTheLightOfTheSamples) {
    const auto one = [](int, int) { return 1.0f; };
    const Halves halves = noisy_halves(kSize, kSize, one, 0.1f, 43);
    const HybridImage image = with(FixedDenoiser(constant(0.8f)), halves, DenoiserQuality::fast);
    EXPECT_NEAR(mean_of(image.color), 1, 0.01);
}

TEST(DenoiserBlend, FastQualityTellsItsErrorByOneHalf) {
    // Half A alone is off by 0.3 from all samples; so is B, the other way, and their mean by less.
    class HalvesDiffer : public FixedDenoiser {
      public:
        HalvesDiffer() : FixedDenoiser(constant(1)) {}
        std::vector<ColorPlanes> denoise(const NoisyFeatures&,
                                         std::vector<NoisyImage> images) const override {
            std::vector<ColorPlanes> results;
            for (const NoisyImage& image : images)
                results.push_back(constant(image.draft ? 1.3f : 1));
            return results;
        }
    };
    const auto one = [](int, int) { return 1.0f; };
    Halves halves = noisy_halves(kSize, kSize, one, 0, 44);
    for (HalfBuffer& half : halves) half.count = Plane(kSize, kSize, 1e6f);
    const HybridImage image = with(HalvesDiffer(), halves, DenoiserQuality::fast);
    const double noise = double(kFastDenoisedError.noise) * 0.3 * 0.3;
    EXPECT_NEAR(image.variance(20, 20), noise, 0.02 * noise);
}

TEST(DenoiserBlend, OneThatFailsIsLeftOutOfFastQuality) {
    const Halves halves = noisy_halves(kSize, kSize, smooth_truth, 0.2f, 35);
    const HybridImage image = with(FailingDenoiser(), halves, DenoiserQuality::fast);
    EXPECT_EQ(image.denoiser_failure, "out of order");
    EXPECT_EQ(image.color[1].values, reconstruct(halves, kSpectrum).color[1].values);
}

TEST(DenoiserBlend, OneThatFailsIsLeftOut) {
    const Halves halves = noisy_halves(kSize, kSize, smooth_truth, 0.2f, 35);
    const HybridImage image = with(FailingDenoiser(), halves);
    EXPECT_EQ(image.denoiser_failure, "out of order");
    EXPECT_EQ(image.color[1].values, reconstruct(halves, kSpectrum).color[1].values);
}

}  // namespace
}  // namespace covtrace
