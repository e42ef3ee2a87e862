// Mixing by measured error, energy, and the limit of many samples, on images that are known.
#include "reconstruction/hybrid.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "reconstruction/error_estimate.h"
#include "reconstruction/outliers.h"
#include "reconstruction/selector.h"
#include "reconstruction_fixtures.h"

namespace covtrace {
namespace {

using namespace test;

constexpr int kSize = 64;
const std::vector<covariance::Sym2<float>> kSpectrum(size_t(kSize) * kSize,
                                                     covariance::Sym2<float>{0.01f, 0, 0.01f});

const ReturnedShares kAllNear{Plane(kSize, kSize, 1), Plane(kSize, kSize)};

float smooth_truth(int x, int y) {
    return 1 + 0.3f * std::sin(0.1f * float(x)) * std::cos(0.07f * float(y));
}
/// Hard squares that no feature and no prediction knows of.
float checks(int x, int y) {
    return (x / 3 + y / 3) % 2 ? 1.0f : 0.2f;
}

ColorPlanes constant(float value) {
    ColorPlanes p;
    p.fill(Plane(kSize, kSize, value));
    return p;
}

ColorPlanes mean_of_both(const std::array<ColorPlanes, 2>& halves) {
    ColorPlanes mean = halves[0];
    for (size_t c = 0; c < 3; ++c)
        for (size_t i = 0; i < mean[c].size(); ++i)
            mean[c][i] = 0.5f * (mean[c][i] + halves[1][c][i]);
    return mean;
}

ColorPlanes weights_at_one(const Halves& halves) {
    return error_weights(halves, constant(1));
}

TEST(Selector, TakesTheTruthAndLeavesTheBias) {
    const auto one = [](int, int) { return 1.0f; };
    const Halves halves = noisy_halves(kSize, kSize, one, 0.5f, 1);
    const std::vector<Candidate> candidates{{halves[0].color, halves[1].color},
                                            {constant(1), constant(1)},
                                            {constant(1.4f), constant(1.4f)}};
    const Selection s = select(halves, candidates, weights_at_one(halves), 3);
    double truth = 0;
    for (float v : s.share[1].values) truth += double(v);
    EXPECT_GT(truth / (kSize * kSize), 0.8);
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

TEST(ErrorWeights, CountEachChannelByItsOwnBrightness) {
    Halves halves = noisy_halves(kSize, kSize, smooth_truth, 0.1f, 1);
    halves[1].count[5] = 0;
    const ColorPlanes g = error_weights(
        halves, {Plane(kSize, kSize, 2), Plane(kSize, kSize), Plane(kSize, kSize, -1)});
    EXPECT_FLOAT_EQ(g[0][0], 1 / 4.01f);
    EXPECT_FLOAT_EQ(g[1][0], 100);
    EXPECT_FLOAT_EQ(g[2][0], 100);  // light is never negative
    EXPECT_FLOAT_EQ(g[0][5], 0);    // nobody judges there
}

/// Mean estimated over mean true squared error of a smooth image.
double told_over_true(float sigma, float samples, uint64_t seed) {
    Halves halves = noisy_halves(kSize, kSize, smooth_truth, sigma, seed);
    for (HalfBuffer& half : halves) half.count = Plane(kSize, kSize, samples / 2);
    const HybridImage image = reconstruct(halves, kSpectrum);
    double told = 0;
    for (float v : image.variance.values) told += double(v) / (kSize * kSize);
    return told / mean_squared_error(image.color, smooth_truth);
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

TEST(ErrorEstimate, IsOfTheErrorsSizeWhateverTheNoise) {
    // Flat noise without features is none of the scenes that the estimate was fitted to.
    for (float sigma : {0.5f, 0.05f}) {
        const double ratio = told_over_true(sigma, 64, 21);
        EXPECT_GT(ratio, 0.4) << "sigma " << sigma;
        EXPECT_LT(ratio, 2.5) << "sigma " << sigma;
    }
}

TEST(ErrorEstimate, FallsWithTheNoise) {
    double before = 1e9;
    for (float sigma : {0.5f, 0.125f, 0.031f}) {
        const HybridImage image =
            reconstruct(noisy_halves(kSize, kSize, checks, sigma, 22), kSpectrum);
        double mean = 0;
        for (float v : image.relative_error.values) mean += double(v);
        EXPECT_LT(mean, before / 4) << "sigma " << sigma;
        before = mean;
    }
}

TEST(ErrorEstimate, CountsNoiseSpreadAndLightThatWasMoved) {
    Halves halves{HalfBuffer(kSize, kSize), HalfBuffer(kSize, kSize)};
    for (HalfBuffer& half : halves) {
        half.count = Plane(kSize, kSize, 4);
        half.color = constant(1);
    }
    const std::vector<Candidate> candidates{{constant(0.9f), constant(0.7f)},
                                            {constant(1.3f), constant(1.1f)}};
    const Selection s{{constant(1.1f), constant(0.9f)},
                      {Plane(kSize, kSize, 0.5f), Plane(kSize, kSize, 0.5f)}};
    const ErrorFactors factors{1, 16, 2, 3, 5};
    const ErrorEstimate error =
        estimate_error(halves, candidates, s, constant(1.05f), constant(1.3f),
                       {Plane(kSize, kSize, 0.5f), Plane(kSize, kSize)}, constant(1), factors);
    // N = 0.1^2 with 8 samples, S = 0.2^2, E = 0.05^2, C = 0.3^2 of which half went further away.
    const float cut = 0.09f * (0.25f + 0.25f / 16);
    const float expected = (3 * 0.01f + 2 * 0.04f + 3 * 0.0025f + 5 * cut) / 1.01f;
    for (size_t i = 0; i < error.color.size(); ++i) {
        ASSERT_NEAR(error.color[i], expected, 1e-4f);
        ASSERT_NEAR(error.luminance[i], expected, 1e-4f);
    }
}

TEST(ErrorEstimate, TellsLuminanceApartFromColours) {
    Halves halves{HalfBuffer(kSize, kSize), HalfBuffer(kSize, kSize)};
    for (HalfBuffer& half : halves) {
        half.count = Plane(kSize, kSize, 4);
        half.color = constant(1);
    }
    // The halves differ in hue and not in luminance.
    ColorPlanes a = constant(1);
    a[0] = Plane(kSize, kSize, 1.3f);
    const float rest = luminance(Rgb(0.3f, 0, 0)) / luminance(Rgb(0, 1, 0));
    a[1] = Plane(kSize, kSize, 1 - rest);
    const Selection s{{a, constant(1)}, {Plane(kSize, kSize, 1)}};
    const ErrorEstimate error =
        estimate_error(halves, std::vector<Candidate>{{a, constant(1)}}, s, mean_of_both(s.half),
                       constant(1), kAllNear, constant(1), {});
    EXPECT_GT(error.color[100], 0.01f);
    EXPECT_LT(error.luminance[100], 1e-6f);
}

TEST(ErrorEstimate, OfWhatStaysInItsPixelIsThatPixels) {
    // One half saw 400 and the other one nothing of it: the pixel is as uncertain as bright.
    Halves halves{HalfBuffer(kSize, kSize), HalfBuffer(kSize, kSize)};
    for (HalfBuffer& half : halves) {
        half.count = Plane(kSize, kSize, 4);
        half.color = constant(1);
    }
    ColorPlanes raw = constant(1);
    ReturnedShares returned = kAllNear;
    for (Plane& p : raw) p(30, 30) = 201;
    returned.near(30, 30) = 0;
    returned.own(30, 30) = 1;
    const Selection s{{constant(1), constant(1)}, {Plane(kSize, kSize, 1)}};
    const ErrorEstimate error =
        estimate_error(halves, std::vector<Candidate>{{constant(1), constant(1)}}, s, raw, raw,
                       returned, constant(1), {});
    EXPECT_NEAR(error.luminance(30, 30), sqr(200.0f / 201), 1e-3f);
    EXPECT_NEAR(error.color(30, 30), sqr(200.0f / 201), 1e-3f);
    EXPECT_EQ(error.luminance(31, 30), 0);
}

TEST(ErrorEstimate, IsToldOfOneSamplePerPixel) {
    // Each pixel is known to one half only, like a checkerboard.
    Halves halves = noisy_halves(kSize, kSize, smooth_truth, 0.2f, 9);
    for (size_t k = 0; k < 2; ++k)
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x)
                halves[k].count(x, y) = size_t(x + y) % 2 == k ? 1.0f : 0.0f;
    const HybridImage image = reconstruct(halves, kSpectrum);
    double told = 0, squares = 0;
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
            told += double(image.variance(x, y));
            squares += sqr(double(image.color[1](x, y)) - double(smooth_truth(x, y)));
        }
    EXPECT_GT(told, 0.2 * squares);
}

TEST(ErrorEstimate, OfADarkPixelIsNotThatOfALightBesideIt) {
    // Halves differ by a tenth of the brightness: in squares, a light errs 10000 times as much.
    Halves halves{HalfBuffer(kSize, kSize), HalfBuffer(kSize, kSize)};
    Selection s{{constant(1), constant(1)}, {Plane(kSize, kSize, 1)}};
    ColorPlanes guess = constant(1);
    for (HalfBuffer& half : halves) half.count = Plane(kSize, kSize, 4);
    for (size_t c = 0; c < 3; ++c)
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x) {
                const float bright = x < kSize / 2 ? 1.0f : 100.0f;
                guess[c](x, y) = bright;
                s.half[0][c](x, y) = 1.05f * bright;
                // The light itself is known: only the pixels in the dark err.
                s.half[1][c](x, y) = x < kSize / 2 ? 0.95f * bright : 1.05f * bright;
                for (HalfBuffer& half : halves) half.color[c](x, y) = bright;
            }
    const ErrorEstimate error =
        estimate_error(halves, std::vector<Candidate>{{s.half[0], s.half[1]}}, s,
                       mean_of_both(s.half), guess, kAllNear, guess, ErrorFactors{1, 0, 0, 0, 0});
    for (int y = 0; y < kSize; ++y) {
        ASSERT_NEAR(error.luminance(kSize / 2 - 1, y), 0.0025f / 1.01f, 1e-6f);
        ASSERT_EQ(error.luminance(kSize / 2, y), 0);
    }
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
    EXPECT_LT(error, 0.25 * raw);  // what the predicted Gaussians leave
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
    // Fits to the samples' own features explain all of the noise here: that they are offered costs.
    // With features that seem to be known exactly it would be 0.54 of the raw pixels' error.
    EXPECT_LT(mean_squared_error(reconstruct(halves, kSpectrum).color, truth), 0.07 * raw);
}

TEST(Selector, WithoutJudgesTakesTheLast) {
    Halves halves{HalfBuffer(kSize, kSize), HalfBuffer(kSize, kSize)};
    const std::vector<Candidate> candidates{{constant(0), constant(0)}, {constant(3), constant(3)}};
    const Selection s = select(halves, candidates, weights_at_one(halves), 3);
    for (float v : s.half[0][0].values) EXPECT_FLOAT_EQ(v, 3);
}

TEST(Outliers, EnergyIsKeptAndThePeakIsGone) {
    const auto one = [](int, int) { return 1.0f; };
    Halves halves = noisy_halves(kSize, kSize, one, 0.1f, 4);
    for (size_t c = 0; c < 3; ++c) halves[0].color[c](31, 33) = 500;
    const double before = 0.5 * (mean_of(halves[0].color) + mean_of(halves[1].color));
    const HybridImage image = reconstruct(halves, kSpectrum);
    EXPECT_NEAR(mean_of(image.color) / before, 1, 2e-3);
    float brightest = 0;
    for (float v : image.color[0].values) brightest = std::max(brightest, v);
    EXPECT_LT(brightest, 2.0f);
}

TEST(Outliers, WhatBothHalvesSeeStays) {
    const auto lamp = [](int x, int y) { return x == 30 && y == 30 ? 500.0f : 1.0f; };
    Halves halves = noisy_halves(kSize, kSize, lamp, 0.1f, 5);
    limit_outliers(halves);
    EXPECT_NEAR(halves[0].color[0](30, 30), 500, 1);
    const HybridImage image = reconstruct(halves, kSpectrum);
    EXPECT_NEAR(image.color[0](30, 30), 500, 25);
}

/// An even image that pixels of `raw` are so much brighter than, on the grid of every `step`-th
/// pixel of the middle `side` ones; all others are off it by a tenth, up and down.
ColorPlanes after_return(int side, int step, float brighter) {
    ColorPlanes raw = constant(0), color = constant(1);
    for (Plane& p : raw)
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x) p(x, y) = (x + y) % 2 ? 1.1f : 0.9f;
    const int first = (kSize - side) / 2;
    for (Plane& p : raw)
        for (int y = first; y < first + side; y += step)
            for (int x = first; x < first + side; x += step) p(x, y) = 1 + brighter;
    const double before = mean_of(raw);
    return_energy(raw, color);
    EXPECT_NEAR(mean_of(color) / before, 1, 1e-4);
    return color;
}

TEST(Outliers, OnePathsLightMakesNoBlotch) {
    // Spread over 12 pixels it would be 0.22 at the middle; the wide Gaussian is cut by the border.
    const ColorPlanes color = after_return(1, 1, 200);
    const auto [least, most] = std::minmax_element(color[0].values.begin(), color[0].values.end());
    EXPECT_LT(*most - *least, 0.06f);
    EXPECT_GT(*least, 1.02f);
}

TEST(Outliers, ASmallLampDoesNotLightTheImage) {
    // One half saw a lamp 100000 times as bright as all else, in one pixel or in a few: spread over
    // 48 pixels it would drown the image.
    for (const int side : {1, 3}) {
        const ColorPlanes color = after_return(side, 1, 1e5f);
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x)
                if (std::max(std::abs(2 * x - kSize), std::abs(2 * y - kSize)) > 2 * side + 2) {
                    ASSERT_NEAR(color[0](x, y), 1, 0.5f) << side << " " << x << " " << y;
                }
        EXPECT_GT(color[0](kSize / 2 - 1, kSize / 2 - 1) + color[0](kSize / 2, kSize / 2), 9e4f);
    }
}

TEST(Outliers, RareNegativeLightIsLimited) {
    // As a pixel filter with negative lobes makes it beside a rare path.
    Halves halves = noisy_halves(kSize, kSize, smooth_truth, 0.1f, 5);
    for (Plane& p : halves[0].color) p(30, 30) = -500;
    limit_outliers(halves);
    EXPECT_GT(halves[0].color[0](30, 30), -5);
    EXPECT_LT(halves[0].color[0](30, 30), 0);
}

TEST(Outliers, LightThatManyPathsBringStaysNear) {
    // 36 pixels of 24 x 24: none brings more than a tenth of what the others do.
    const ColorPlanes color = after_return(24, 4, 200);
    const float middle = color[0](kSize / 2, kSize / 2), corner = color[0](1, 1);
    EXPECT_GT(middle, 4.0f);
    EXPECT_LT(corner - 1, 0.1f * (middle - 1));
}

TEST(Hybrid, CleansASmoothImage) {
    const Halves halves = noisy_halves(kSize, kSize, smooth_truth, 0.3f, 6);
    const double raw = 0.3 * 0.3 / 2;
    EXPECT_LT(mean_squared_error(reconstruct(halves, kSpectrum).color, smooth_truth), 0.1 * raw);
}

TEST(Hybrid, IsNeverWorseThanThePixelsAndBecomesThem) {
    // Noise as of n = 4 ... 16384 samples. The predicted filters of 0.8 pixels blur these squares
    // whatever the noise; the error must fall with it all the same.
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
