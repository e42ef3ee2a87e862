// Mixing by measured error, energy, and the limit of many samples, on images that are known.
#include "reconstruction/hybrid.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "reconstruction/selector.h"
#include "reconstruction_images.h"

namespace covtrace {
namespace {

using namespace test;

ColorPlanes weights_at_one(const Halves& halves) {
    return error_weights(halves, constant(1));
}

/// The selection where the truth is 1, among the raw pixels, the truth, and a biased candidate.
Selection of_raw_truth_and_bias(const Halves& halves) {
    const std::vector<Candidate> candidates{{halves[0].color, halves[1].color},
                                            {constant(1), constant(1)},
                                            {constant(1.4f), constant(1.4f)}};
    return select(halves, candidates, weights_at_one(halves), 3);
}

double share_of_truth(const Selection& s) {
    double sum = 0;
    for (float v : s.share[1].values) sum += double(v);
    return sum / (kSize * kSize);
}

TEST(Selector, TakesTheTruthAndLeavesTheBias) {
    const auto one = [](int, int) { return 1.0f; };
    const Halves halves = noisy_halves(kSize, kSize, one, 0.5f, 1);
    const Selection s = of_raw_truth_and_bias(halves);
    EXPECT_GT(share_of_truth(s), 0.8);
    EXPECT_LT(mean_squared_error(s.half[0], one), 0.25 * 0.25 * 0.1);
}

TEST(Selector, MixesOppositeBiases) {
    const auto one = [](int, int) { return 1.0f; };
    const Halves halves = noisy_halves(kSize, kSize, one, 0.1f, 2);
    const std::vector<Candidate> candidates{{constant(0.8f), constant(0.8f)},
                                            {constant(1.3f), constant(1.3f)}};
    const Selection s = select(halves, candidates, weights_at_one(halves), 3);
    // The best single candidate has 0.04; the mixture 0.6 : 0.4 has none.
    EXPECT_LT(mean_squared_error(s.half[0], one), 0.004);
}

/// Halves that have seen every second pixel each, like the squares of a checkerboard: one sample
/// per pixel.
Halves checkerboard(const Halves& all) {
    Halves halves = all;
    for (size_t k = 0; k < 2; ++k) {
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x) halves[k].count(x, y) = (x + y) % 2 == int(k) ? 1 : 0;
        fill_holes(halves[k]);
    }
    return halves;
}

TEST(Selector, JudgesHalvesThatHaveNoPixelInCommon) {
    const auto one = [](int, int) { return 1.0f; };
    const Halves halves = checkerboard(noisy_halves(kSize, kSize, one, 0.5f, 3));
    EXPECT_GT(share_of_truth(of_raw_truth_and_bias(halves)), 0.8);
}

TEST(ErrorWeights, CountEachChannelByItsOwnBrightness) {
    Halves halves = noisy_halves(kSize, kSize, smooth_truth, 0.1f, 1);
    for (HalfBuffer& half : halves) half.count[5] = 0;
    const ColorPlanes g = error_weights(
        halves, {Plane(kSize, kSize, 2), Plane(kSize, kSize), Plane(kSize, kSize, -1)});
    EXPECT_FLOAT_EQ(g[0][0], 1 / 4.01f);
    EXPECT_FLOAT_EQ(g[1][0], 100);
    EXPECT_FLOAT_EQ(g[2][0], 1 / 1.01f);  // negative light, as beside lamps, counts as much
    EXPECT_FLOAT_EQ(g[0][5], 0);          // nobody judges there
}

TEST(Hybrid, AHalfWithoutSamplesIsNotBlack) {
    for (size_t empty : {0u, 1u}) {
        Halves halves = noisy_halves(kSize, kSize, smooth_truth, 0.1f, 23);
        halves[empty] = HalfBuffer(kSize, kSize);
        const HybridImage image = reconstruct(halves, kSpectrum);
        EXPECT_LT(mean_squared_error(image.color, smooth_truth), 0.1 * 0.1) << "half " << empty;
    }
}

TEST(Hybrid, WhereOneHalfHasNoSampleTheOtherTellsTheLight) {
    // One half has seen the bright left, the other one the rest: neither may fill the other's light
    // in, which would make the mean 0.55.
    constexpr int kBright = kSize / 4;
    const auto truth = [](int x, int) { return x < kBright ? 1.0f : 0.1f; };
    Halves halves = noisy_halves(kSize, kSize, truth, 0.01f, 24);
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) halves[x < kBright ? 1 : 0].count(x, y) = 0;
    const HybridImage image = reconstruct(halves, kSpectrum);
    double light = 0;
    for (float v : image.color[1].values) light += double(v) / (kSize * kSize);
    EXPECT_NEAR(light, 0.325, 0.02);
}

TEST(Hybrid, NoiseOfFeaturesIsNoDetail) {
    // Two samples of each half see either of two surfaces, and features whose spread is not known
    // explain the colours altogether.
    Halves halves{HalfBuffer(kSize, kSize), HalfBuffer(kSize, kSize)};
    Rng rng(31);
    for (HalfBuffer& half : halves) {
        half.count = Plane(kSize, kSize, 2);
        for (size_t i = 0; i < half.count.size(); ++i) {
            const float seen =
                (float(rng.next_float() < 0.5f) + float(rng.next_float() < 0.5f)) / 2;
            for (size_t c = 0; c < 3; ++c) {
                half.color[c][i] = half.feature[c][i] = seen;
                half.color_variance[c][i] = 0.125f;
            }
        }
    }
    const auto truth = [](int, int) { return 0.5f; };
    const HybridImage image = reconstruct(halves, kSpectrum);
    const double error = mean_squared_error(image.color, truth), raw = 0.125 / 2;
    EXPECT_LT(error, 0.25 * raw);  // the predicted Gaussians leave this much
    double told = 0;
    for (float v : image.variance.values) told += double(v) / (kSize * kSize);
    EXPECT_GT(told / error, 0.4);
}

TEST(Hybrid, OneSampleOfEachHalfKnowsThatFeaturesVary) {
    // Every second pixel sees the same surface in both halves, and nothing of its spread.
    Halves halves{HalfBuffer(kSize, kSize), HalfBuffer(kSize, kSize)};
    Rng rng(32);
    for (HalfBuffer& half : halves) {
        half.count = Plane(kSize, kSize, 1);
        for (size_t i = 0; i < half.count.size(); ++i) {
            const float seen = rng.next_float() < 0.5f ? 1.0f : 0.0f;
            for (size_t c = 0; c < 3; ++c) half.color[c][i] = half.feature[c][i] = seen;
        }
    }
    set_variance_from_difference(halves);
    const auto truth = [](int, int) { return 0.5f; };
    const double raw = 0.25 / 2;
    // Fits to the samples' own features explain all of the noise here: offering them costs. With
    // features that seem to be known exactly it would be 0.54 of the raw pixels' error.
    EXPECT_LT(mean_squared_error(reconstruct(halves, kSpectrum).color, truth), 0.08 * raw);
}

TEST(Selector, WithoutJudgesTakesTheLast) {
    Halves halves{HalfBuffer(kSize, kSize), HalfBuffer(kSize, kSize)};
    const std::vector<Candidate> candidates{{constant(0), constant(0)}, {constant(3), constant(3)}};
    const Selection s = select(halves, candidates, weights_at_one(halves), 3);
    for (float v : s.half[0][0].values) EXPECT_FLOAT_EQ(v, 3);
}

TEST(Hybrid, CleansASmoothImage) {
    const Halves halves = noisy_halves(kSize, kSize, smooth_truth, 0.3f, 6);
    const double raw = 0.3 * 0.3 / 2;
    EXPECT_LT(mean_squared_error(reconstruct(halves, kSpectrum).color, smooth_truth), 0.1 * raw);
}

TEST(Hybrid, WithoutAPredictionItCleansByFitsAlone) {
    const HybridImage image = reconstruct(noisy_halves(kSize, kSize, smooth_truth, 0.3f, 3), {});
    EXPECT_LT(mean_squared_error(image.color, smooth_truth), 0.06 * 0.5 * 0.3 * 0.3);
    EXPECT_EQ(image.share.size(), 1 + CandidateSettings().fits.size());  // the raw pixels, the fits
}

TEST(Hybrid, IsNeverWorseThanThePixelsAndBecomesThem) {
    // The noise is that of n = 4 ... 16384 samples. The predicted filters of 0.8 pixels blur these
    // squares whatever the noise; the error must fall with it all the same.
    double before = 1e9;
    for (float sigma : {0.5f, 0.125f, 0.031f, 0.0078f}) {
        const Halves halves = noisy_halves(kSize, kSize, checks, sigma, 7);
        const double raw = double(sigma) * double(sigma) / 2;
        const double error = mean_squared_error(reconstruct(halves, kSpectrum).color, checks);
        EXPECT_LT(error, 1.05 * raw) << "sigma " << sigma;
        EXPECT_LT(error, before / 4) << "sigma " << sigma;
        before = error;
    }
}

/// Halves of hard squares of 0.2 and 1, as noisy as they are bright, times `factor`.
Halves dim_halves(float factor) {
    const auto truth = [&](int x, int y) { return factor * checks(x / 4, y / 4); };
    return noisy_halves(kSize, kSize, truth, 0.2f * factor, 10);
}

TEST(Hybrid, DimImagesAreReconstructedAsInOtherUnits) {
    const float factor = 0x1p-10f;
    const HybridImage dim = reconstruct(dim_halves(factor), kSpectrum),
                      dimmer = reconstruct(dim_halves(factor / 4), kSpectrum);
    for (size_t i = 0; i < dim.variance.size(); ++i) {
        for (size_t c = 0; c < 3; ++c) ASSERT_EQ(dimmer.color[c][i], dim.color[c][i] / 4);
        ASSERT_NEAR(dimmer.variance[i], dim.variance[i] / 16, 1e-4f * dim.variance[i]);
        // The error is told over I^2 + 0.01 in the image's own units, where I^2 is next to nothing.
        ASSERT_NEAR(dimmer.relative_error[i], dim.relative_error[i] / 16,
                    1e-3f * dim.relative_error[i]);
    }
    const auto truth = [&](int x, int y) { return factor * checks(x / 4, y / 4); };
    EXPECT_LT(mean_squared_error(dim.color, truth), 0.25 * sqr(0.2 * double(factor)) / 2);
}

TEST(Hybrid, HolesAreFilled) {
    Halves halves = noisy_halves(kSize, kSize, smooth_truth, 0.1f, 8);
    Rng rng(9);
    for (HalfBuffer& half : halves)
        for (size_t i = 0; i < half.count.size(); ++i)
            if (rng.next_float() < 0.6f) {
                half.count[i] = 0;
                for (Plane& p : half.color) p[i] = 0;
            }
    EXPECT_LT(mean_squared_error(reconstruct(halves, kSpectrum).color, smooth_truth), 0.01);
}

}  // namespace
}  // namespace covtrace
