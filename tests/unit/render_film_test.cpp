// Films: means, squares and the light in view that samples of either weight leave in a pixel.
#include "render/film.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace covtrace {
namespace {

FilmSample sample_of(float radiance, float weight) {
    FilmSample s;
    s.radiance = Rgb(radiance);
    s.in_view = Rgb(radiance / 2);
    s.weight = weight;
    return s;
}

TEST(Film, WeightsOfAConstantImageAreNotSeen) {
    Film film({0, 0, 1, 1}, {.in_view = true});
    std::mt19937 random(1);
    std::uniform_real_distribution<float> weight(-2, 3);
    for (int i = 0; i < 50; ++i) {
        film.add(0, sample_of(0.75f, weight(random)));
        EXPECT_EQ(film.pixels[0].mean.g, 0.75f);
        EXPECT_EQ(film.in_view[0].g, 0.375f);
        EXPECT_EQ(film.pixels[0].squares.g, 0);
    }
}

TEST(Film, EqualWeightsGiveMeanAndSquares) {
    Film film({0, 0, 1, 1});
    double sum = 0, squares = 0;
    const float values[] = {1, 4, 2, 8, 5, 7};
    for (const float v : values) {
        film.add(0, sample_of(v, 1));
        sum += v;
    }
    const double mean = sum / 6;
    for (const float v : values) squares += (v - mean) * (v - mean);
    EXPECT_NEAR(film.pixels[0].mean.r, mean, 1e-6);
    EXPECT_NEAR(film.pixels[0].squares.r, squares, 1e-5);
    EXPECT_NEAR(film.pixels[0].variance_of_mean().r, squares / 30, 1e-6);
}

/// Samples have the weights 1.5 and -1 (mean 1), on which their radiance depends: the mean is that
/// of weight times radiance but for the first sample, which counts as it is; and the variance told
/// is the one that many films have. Four comparisons at 4.5 standard errors: false alarm 3e-5.
TEST(Film, SignedWeightsKeepTheWeightedMean) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> u(0, 1);
    const double plain = 0.8 * 2 + 0.2 * 1, weighted = 0.8 * 1.5 * 2 - 0.2 * 1;
    for (const int n : {4, 32}) {
        double sum = 0, squares = 0, told = 0, told_squares = 0;
        const int films = 40000;
        for (int k = 0; k < films; ++k) {
            FilmPixel pixel;
            for (int i = 0; i < n; ++i) {
                const bool lobe = u(random) < 0.2;
                const double noise = u(random) - 0.5;
                pixel.add(sample_of(float((lobe ? 1 : 2) + noise), lobe ? -1.0f : 1.5f));
            }
            sum += pixel.mean.r;
            squares += double(pixel.mean.r) * pixel.mean.r;
            const double variance = pixel.variance_of_mean().r;
            told += variance;
            told_squares += variance * variance;
        }
        const double mean = sum / films, variance = squares / films - mean * mean;
        EXPECT_NEAR(mean, weighted + (plain - weighted) / n, 4.5 * std::sqrt(variance / films));
        told /= films;
        const double error = std::sqrt((told_squares / films - told * told) / films);
        // Terms of 1/n^2 are not told.
        EXPECT_NEAR(told, variance, 4.5 * error + 1.5 * variance / n) << n;
    }
}

}  // namespace
}  // namespace covtrace
