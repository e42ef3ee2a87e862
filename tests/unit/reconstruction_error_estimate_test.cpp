// Estimates of errors: their size, their places, and the terms that they are made of.
#include "reconstruction/error_estimate.h"

#include <gtest/gtest.h>

#include "reconstruction/hybrid.h"
#include "reconstruction/luminance.h"
#include "reconstruction_images.h"

namespace covtrace {
namespace {

using namespace test;

/// Four samples of 1 in every pixel of both halves.
Halves even_halves() {
    Halves halves{HalfBuffer(kSize, kSize), HalfBuffer(kSize, kSize)};
    for (HalfBuffer& half : halves) {
        half.count = Plane(kSize, kSize, 4);
        half.color = constant(1);
    }
    return halves;
}

/// The mean estimated over the mean true squared error of a smooth image.
double told_over_true(float sigma, float samples, uint64_t seed) {
    Halves halves = noisy_halves(kSize, kSize, smooth_truth, sigma, seed);
    for (HalfBuffer& half : halves) half.count = Plane(kSize, kSize, samples / 2);
    const HybridImage image = reconstruct(halves, kSpectrum);
    double told = 0;
    for (float v : image.variance.values) told += double(v) / (kSize * kSize);
    return told / mean_squared_error(image.color, smooth_truth);
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
    const Halves halves = even_halves();
    const std::vector<Candidate> candidates{{constant(0.9f), constant(0.7f)},
                                            {constant(1.3f), constant(1.1f)}};
    const Selection s{{constant(1.1f), constant(0.9f)},
                      {Plane(kSize, kSize, 0.5f), Plane(kSize, kSize, 0.5f)}};
    const ErrorFactors factors{1, 16, 2, 3, 5};
    const ErrorEstimate error =
        estimate_error(halves, candidates, s, constant(1.05f), constant(1.3f), constant(1), nullptr,
                       factors, kDarkSquared);
    // The terms are N = 0.1^2 with 8 samples, S = 0.2^2, E = 0.05^2, C = 0.3^2.
    const float expected = (3 * 0.01f + 2 * 0.04f + 3 * 0.0025f + 5 * 0.09f) / 1.01f;
    for (size_t i = 0; i < error.color.size(); ++i) {
        ASSERT_NEAR(error.color[i], expected, 1e-4f);
        ASSERT_NEAR(error.luminance[i], expected, 1e-4f);
    }
}

TEST(ErrorEstimate, TellsLuminanceApartFromColours) {
    const Halves halves = even_halves();
    // The halves differ in hue and not in luminance.
    ColorPlanes a = constant(1);
    a[0] = Plane(kSize, kSize, 1.3f);
    const float rest = luminance(Rgb(0.3f, 0, 0)) / luminance(Rgb(0, 1, 0));
    a[1] = Plane(kSize, kSize, 1 - rest);
    const Selection s{{a, constant(1)}, {Plane(kSize, kSize, 1)}};
    const ErrorEstimate error =
        estimate_error(halves, std::vector<Candidate>{{a, constant(1)}}, s, mean_of_both(s.half),
                       constant(1), constant(1), nullptr, {}, kDarkSquared);
    EXPECT_GT(error.color[100], 0.01f);
    EXPECT_LT(error.luminance[100], 1e-6f);
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
    const ErrorEstimate error = estimate_error(
        halves, std::vector<Candidate>{{s.half[0], s.half[1]}}, s, mean_of_both(s.half), guess,
        guess, nullptr, ErrorFactors{1, 0, 0, 0, 0}, kDarkSquared);
    for (int y = 0; y < kSize; ++y) {
        ASSERT_NEAR(error.luminance(kSize / 2 - 1, y), 0.0025f / 1.01f, 1e-6f);
        ASSERT_EQ(error.luminance(kSize / 2, y), 0);
    }
}

}  // namespace
}  // namespace covtrace
