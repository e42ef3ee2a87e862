// First-order regression: exact for linear colours, and blind to pixels without samples.
#include "reconstruction/regression.h"

#include <gtest/gtest.h>

#include "core/simd.h"
#include "reconstruction_fixtures.h"

namespace covtrace {
namespace {

constexpr int kWidth = 41, kHeight = 37;

struct Linear {
    Halves halves{HalfBuffer(kWidth, kHeight), HalfBuffer(kWidth, kHeight)};
    FeaturePlanes features;
};

/// An image of colours that are linear in random features and in the position; variances so large
/// that all patches count as alike.
Linear linear_image() {
    Linear l;
    Rng rng(3);
    for (Plane& f : l.features) {
        f = Plane(kWidth, kHeight);
        for (float& v : f.values) v = rng.next_float();
    }
    for (HalfBuffer& half : l.halves)
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                half.count(x, y) = 4;
                for (size_t c = 0; c < 3; ++c) {
                    float value = 1 + 0.02f * float(x) - 0.03f * float(y);
                    for (size_t f = 0; f < kFeatures; ++f)
                        value += (0.3f * float(f) - float(c)) * l.features[f](x, y);
                    half.color[c](x, y) = value;
                    half.color_variance[c](x, y) = 1e3f;
                }
            }
    return l;
}

TEST(Regression, ReproducesLinearFunctionsOfFeaturesAndPosition) {
    const Linear l = linear_image();
    const RegressionWindow window;
    const auto fitted = regress(l.halves[0], l.halves[1], l.features, std::span(&window, 1));
    // Seven slopes of up to 2 over features in [0, 1]: the ridge takes 0.1 % of each.
    for (size_t c = 0; c < 3; ++c)
        for (size_t i = 0; i < fitted[0][c].size(); ++i)
            EXPECT_NEAR(fitted[0][c][i], l.halves[0].color[c][i], 14e-3f);
}

TEST(Regression, ExplainsColoursByTheSamplesOwnFeaturesWhereAsked) {
    Linear l = linear_image();
    for (HalfBuffer& half : l.halves) half.feature = l.features;
    FeaturePlanes filtered;  // features freed of all detail
    filtered.fill(Plane(kWidth, kHeight, 0.5f));
    const std::array windows{RegressionWindow{.noise = FeatureNoise::kept}, RegressionWindow{}};
    const auto fitted = regress(l.halves[0], l.halves[1], filtered, windows);
    float worst = 0, worst_filtered = 0;
    for (size_t c = 0; c < 3; ++c)
        for (size_t i = 0; i < fitted[0][c].size(); ++i) {
            const float truth = l.halves[0].color[c][i];
            worst = std::max(worst, std::abs(fitted[0][c][i] - truth));
            worst_filtered = std::max(worst_filtered, std::abs(fitted[1][c][i] - truth));
        }
    EXPECT_LT(worst, 14e-3f);
    EXPECT_GT(worst_filtered, 0.5f);
}

TEST(Regression, PixelsWithoutSamplesTakeNoPart) {
    Linear l = linear_image();
    Rng rng(5);
    for (size_t i = 0; i < l.halves[0].count.size(); ++i)
        if (rng.next_float() < 0.3f) {
            l.halves[0].count[i] = 0;
            for (Plane& p : l.halves[0].color) p[i] = 1e6f;
        }
    const RegressionWindow window;
    const auto fitted = regress(l.halves[0], l.halves[1], l.features, std::span(&window, 1));
    for (size_t c = 0; c < 3; ++c)
        for (size_t i = 0; i < fitted[0][c].size(); ++i)
            EXPECT_NEAR(fitted[0][c][i], l.halves[1].color[c][i], 20e-3f);
}

TEST(Regression, DoesNotMixWhatTheOtherHalfTellsApart) {
    // The image is two flat halves, far apart in units of the noise: the border stays sharp.
    const auto step = [](int x, int) { return x < 20 ? 1.0f : 2.0f; };
    const Halves halves = test::noisy_halves(kWidth, kHeight, step, 0.01f, 1);
    FeaturePlanes features;
    features.fill(Plane(kWidth, kHeight));
    const RegressionWindow window;
    const auto fitted = regress(halves[0], halves[1], features, std::span(&window, 1));
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) EXPECT_NEAR(fitted[0][0](x, y), step(x, y), 0.03f);
}

TEST(Regression, TexturesUnderEvenLightShareTheirSamples) {
    // Colours of no two pixels are alike, but their light is; the albedo is a feature.
    FeaturePlanes features;
    features.fill(Plane(kWidth, kHeight));
    Rng rng(11);
    for (size_t i = 0; i < features[0].size(); ++i)
        features[0][i] = features[1][i] = features[2][i] = 0.4f + 0.4f * rng.next_float();
    const float sigma = 0.01f;
    const auto color = [&](int x, int y) { return features[0](x, y) * (1 + 0.001f * float(x)); };
    Halves halves = test::noisy_halves(kWidth, kHeight, color, sigma, 2);
    for (HalfBuffer& half : halves) half.feature = features;
    const std::array windows{RegressionWindow{},
                             RegressionWindow{.patches = PatchesOf::colors_or_light}};
    const auto fitted = regress(halves[0], halves[1], features, windows);
    double squares[2] = {0, 0};
    for (size_t k = 0; k < 2; ++k)
        for (size_t c = 0; c < 3; ++c)
            for (int y = 0; y < kHeight; ++y)
                for (int x = 0; x < kWidth; ++x)
                    squares[k] += sqr(double(fitted[k][c](x, y) - color(x, y)) / sigma);
    const double n = 3.0 * kWidth * kHeight;
    EXPECT_GT(squares[0] / n, 0.5);
    EXPECT_LT(squares[1] / n, 0.1);
}

TEST(Regression, LightTellsPatchesApartOnlyWhereNoiseDoesNot) {
    // The image is stripes under even light: told apart by colours, and alike by light, with little
    // noise.
    FeaturePlanes features;
    features.fill(Plane(kWidth, kHeight));
    const auto albedo = [](int x, int) { return x % 4 < 2 ? 0.3f : 0.8f; };
    for (size_t c = 0; c < 3; ++c)
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) features[c](x, y) = albedo(x, y);
    const std::array windows{RegressionWindow{},
                             RegressionWindow{.patches = PatchesOf::colors_or_light}};
    for (const float sigma : {0.02f, 0.2f}) {
        Halves halves = test::noisy_halves(kWidth, kHeight, albedo, sigma, 2);
        for (HalfBuffer& half : halves) half.feature = features;
        const auto fitted = regress(halves[0], halves[1], features, windows);
        float difference = 0;
        for (size_t i = 0; i < fitted[0][0].size(); ++i)
            difference = std::max(difference, std::abs(fitted[0][0][i] - fitted[1][0][i]));
        if (sigma < 0.1f)
            EXPECT_GT(difference, 1e-3f);
        else
            EXPECT_EQ(difference, 0);
    }
}

TEST(Regression, ExponentialIsExact) {
    for (int i = 0; i < 1000; ++i) {
        const float x = -0.09f * float(i);
        const Float8 y = exp_of_negative(x - Float8{});
        const float expected = std::exp(std::max(x, -80.0f));
        for (size_t k = 0; k < kLanes; ++k) EXPECT_NEAR(y[k] / expected, 1, 5e-6f) << x;
    }
}

}  // namespace
}  // namespace covtrace
