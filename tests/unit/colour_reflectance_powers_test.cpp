/// Colours of powers of a reflectance's spectrum, against sums over wavelengths.
#include "colour/reflectance_powers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "colour/sigmoid_spectrum.h"
#include "core/parallel.h"
#include "core/rng.h"

namespace covtrace::test {
namespace {

constexpr Rgb kRed{0.8f, 0.1f, 0.1f}, kCandle{1, 0.3f, 0.05f};
/// Share of light from inside that a smooth interface of index 1.5 sends back.
constexpr float kAgain = 0.596f;

float largest_difference(Rgb a, Rgb b) {
    return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
}

/// Colour of the sum of again^j S^(j + 1) over j < bounces at each wavelength; not below 0.
Rgb sum_of_spectra(Rgb reflectance, float again, int bounces) {
    const SigmoidSpectrum spectrum = sigmoid_spectrum(reflectance);
    std::array<double, 3> colour{};
    for (const ObserverSample& sample : observer_samples()) {
        const double s = spectrum.at(sample.wavelength);
        double sum = 0, term = s;
        for (int j = 0; j < bounces; ++j) {
            sum += term;
            term *= s * again;
        }
        for (size_t c = 0; c < 3; ++c) colour[c] += sum * sample.weight[c];
    }
    for (double& c : colour) c = std::max(c, 0.0);
    return {static_cast<float>(colour[0]), static_cast<float>(colour[1]),
            static_cast<float>(colour[2])};
}

Rgb random_colour(Rng& rng) {
    Rgb c{rng.next_float(), rng.next_float(), rng.next_float()};
    if (rng.next_float() < 0.5f) c = c * c;
    return c;
}

TEST(SceneReflectancePowers, AreThoseOfTheSpectrum) {
    Rng rng(5);
    for (int i = 0; i < 500; ++i) {
        const Rgb c = random_colour(rng);
        for (const int bounces : {0, 1, 2, 5})
            ASSERT_LT(largest_difference(sum_of_bounces(reflectance_powers(c), kAgain, bounces),
                                         sum_of_spectra(c, kAgain, bounces)),
                      2e-4f)  // the darkest and brightest spectra end 1e-4 before black and white
                << c.r << " " << c.g << " " << c.b << ", " << bounces;
    }
}

TEST(SceneReflectancePowers, OfColouredLightAreOverTheLight) {
    const IlluminantAdaptation light(kCandle);
    const SigmoidSpectrum lamp = sigmoid_spectrum(0.5f * kCandle);
    const ReflectancePowersTable table(light);
    Rng rng(8);
    for (int i = 0; i < 500; ++i) {
        const Rgb c = random_colour(rng);
        const SigmoidSpectrum spectrum = sigmoid_spectrum(c);
        const ReflectancePowers powers = reflectance_powers(c, light);
        EXPECT_EQ(powers[0], light(c));
        std::array<double, 3> cube{}, white{};
        for (const ObserverSample& sample : observer_samples())
            for (size_t k = 0; k < 3; ++k) {
                const double lit = lamp.at(sample.wavelength) * sample.weight[k];
                white[k] += lit;
                cube[k] += lit * std::pow(spectrum.at(sample.wavelength), 3);
            }
        const Rgb looked_up = table(c)[2];
        for (int k = 0; k < 3; ++k) {
            const auto channel = static_cast<size_t>(k);
            ASSERT_NEAR(powers[2][k], cube[channel] / white[channel], 1e-5);
            ASSERT_NEAR(looked_up[k], powers[2][k], 0.02);
        }
    }
}

TEST(SceneReflectancePowers, SaturatedColoursLoseWhatTheyHardlyHave) {
    const ReflectancePowers powers = reflectance_powers(kRed);
    const Rgb squares = kRed * kRed;
    EXPECT_EQ(powers[0], kRed);
    EXPECT_LT(powers[1].g, 0.5f * squares.g);
    const Rgb all = sum_of_bounces(powers, kAgain, 5);
    const float per_channel = 0.1f * (1 - std::pow(0.1f * kAgain, 5.0f)) / (1 - 0.1f * kAgain);
    EXPECT_LT(all.g, 0.9f * per_channel);
}

TEST(SceneReflectancePowers, GoOnPastTheLastOneKnown) {
    Rng rng(6);
    for (int i = 0; i < 500; ++i) {
        const Rgb c = 0.9f * random_colour(rng);
        for (const int bounces : {6, 10, 100, 1'000'000'000}) {
            const Rgb truth = sum_of_spectra(c, kAgain, std::min(bounces, 200));
            ASSERT_LT(
                largest_difference(sum_of_bounces(reflectance_powers(c), kAgain, bounces), truth),
                0.015f * max_component(truth))
                << c.r << " " << c.g << " " << c.b << ", " << bounces;
        }
    }
    EXPECT_NEAR(sum_of_bounces(reflectance_powers(Rgb(1)), 1, 1000).g, 1000, 1e-2);
}

TEST(SceneReflectancePowers, GreysAreExact) {
    const ReflectancePowersTable table{IlluminantAdaptation()};
    for (const float v : {0.0f, 0.003f, 0.18f, 0.5f, 0.77f, 1.0f}) {
        float power = 1;
        for (size_t j = 0; j < ReflectancePowers{}.size(); ++j) {
            power *= v;
            EXPECT_FLOAT_EQ(reflectance_powers(Rgb(v))[j].g, power);
            EXPECT_EQ(table(Rgb(v))[j], reflectance_powers(Rgb(v))[j]);
        }
    }
    EXPECT_FLOAT_EQ(sum_of_bounces(reflectance_powers(Rgb(0.5f)), 0.5f, 1000).g, 0.5f / 0.75f);
}

TEST(SceneReflectancePowers, TableAgreesWithTheFit) {
    const ReflectancePowersTable table{IlluminantAdaptation()};
    Rng rng(7);
    for (int i = 0; i < 4000; ++i) {
        const Rgb c = random_colour(rng);
        ASSERT_LT(largest_difference(sum_of_bounces(table(c), kAgain, 5),
                                     sum_of_bounces(reflectance_powers(c), kAgain, 5)),
                  0.005f)
            << c.r << " " << c.g << " " << c.b;
    }
    EXPECT_EQ(ReflectancePowersTable()(kRed)[1], kRed * kRed);
}

TEST(SceneReflectancePowers, ExtremesAreSafe) {
    const ReflectancePowersTable table{IlluminantAdaptation()};
    for (const float r : {-1.0f, 0.0f, 1e-7f, 0.5f, 1.0f, 3.0f, NAN, INFINITY})
        for (const float g : {0.0f, 1e-4f, 1.0f})
            for (const float b : {0.0f, 0.3f, 1.0f}) {
                for (const ReflectancePowers& powers :
                     {reflectance_powers({r, g, b}), table({r, g, b})})
                    for (const float again : {0.0f, 0.6f, 1.0f})
                        for (const int bounces : {1, 5, 50}) {
                            const Rgb sum = sum_of_bounces(powers, again, bounces);
                            for (int c = 0; c < 3; ++c) {
                                ASSERT_GE(sum[c], 0) << r << " " << g << " " << b;
                                ASSERT_LE(sum[c], 1.01f * static_cast<float>(bounces))
                                    << r << " " << g << " " << b;
                            }
                        }
            }
}

TEST(SceneReflectancePowers, TheNumberOfThreadsDoesNotMatter) {
    const auto powers = [](int threads) {
        const ThreadLimit limit(threads);
        return ReflectancePowersTable(IlluminantAdaptation(kCandle))({0.3f, 0.7f, 0.2f});
    };
    EXPECT_EQ(powers(1), powers(4));
}

}  // namespace
}  // namespace covtrace::test
