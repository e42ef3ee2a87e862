/// Reflectances adapted to coloured light, against products of whole spectra.
#include "colour/illuminant_adaptation.h"

#include <gtest/gtest.h>

#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <string>

#include "colour/sigmoid_spectrum.h"
#include "core/parallel.h"
#include "core/rng.h"

namespace covtrace::test {
namespace {

const Rgb kCornellLight{17, 12, 4}, kCandle{1, 0.3f, 0.05f};
const Rgb kWhiteWall{0.725f, 0.71f, 0.68f}, kRedWall{0.63f, 0.065f, 0.05f},
    kGreenWall{0.14f, 0.45f, 0.091f};

float largest_difference(Rgb a, Rgb b) {
    return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
}

/// Colour under D65 of light that met surfaces of these spectra: of the product of all.
Rgb product_colour(const std::vector<SigmoidSpectrum>& factors) {
    std::array<double, 3> sum{};
    for (const ObserverSample& s : observer_samples()) {
        double product = 1;
        for (const SigmoidSpectrum& f : factors) product *= f.at(s.wavelength);
        for (size_t c = 0; c < 3; ++c) sum[c] += product * s.weight[c];
    }
    return {static_cast<float>(sum[0]), static_cast<float>(sum[1]), static_cast<float>(sum[2])};
}

Rgb random_colour(Rng& rng) {
    Rgb c{rng.next_float(), rng.next_float(), rng.next_float()};
    if (rng.next_float() < 0.5f) c = c * c;
    return c;
}

TEST(SceneSigmoidSpectrum, HasTheColourAskedFor) {
    for (int r = 0; r <= 8; ++r)
        for (int g = 0; g <= 8; ++g)
            for (int b = 0; b <= 8; ++b) {
                const Rgb wanted{sqr(float(r) / 8), sqr(float(g) / 8), sqr(float(b) / 8)};
                const SigmoidSpectrum s = sigmoid_spectrum(wanted);
                // Targets end 1e-4 before black and white.
                ASSERT_LT(largest_difference(product_colour({s}), wanted), 2e-4f)
                    << r << " " << g << " " << b;
            }
    EXPECT_LT(largest_difference(product_colour({sigmoid_spectrum(kRedWall)}), kRedWall), 2e-6f);
}

TEST(SceneSigmoidSpectrum, GreysAreConstant) {
    for (const float v : {0.0f, 0.2f, 0.5f, 1.0f}) {
        const SigmoidSpectrum s = sigmoid_spectrum(Rgb(v));
        for (double nm = 380; nm <= 780; nm += 50) EXPECT_NEAR(s.at(nm), v, 1.01e-4);
    }
}

TEST(SceneSigmoidSpectrum, UnboundedFactorsKeepTheirColour) {
    for (const Rgb c : {Rgb{3.9f, 2.45f, 2.14f}, Rgb{0.2f, 0.92f, 1.1f}, Rgb{7}, Rgb{0, 0, 2}})
        EXPECT_LT(largest_difference(reflectance_colour(unbounded_spectrum(c)), c),
                  3e-4f * max_component(c));
    EXPECT_LT(max_component(reflectance_colour(unbounded_spectrum(Rgb{}))), 1e-6f);
}

TEST(SceneIlluminantAdaptation, WhiteLightChangesNothing) {
    for (const Rgb light : {Rgb(1), Rgb(250), Rgb(1e-6f), Rgb{1, 0.9999f, 1}, Rgb{}, Rgb{NAN, 1, 1},
                            Rgb{kInfinity, 1, 1}, Rgb(-1)}) {
        const IlluminantAdaptation adaptation(light);
        EXPECT_TRUE(adaptation.is_identity());
        EXPECT_EQ(adaptation(kRedWall), kRedWall);
        EXPECT_EQ(AdaptationTable(adaptation)(kRedWall), kRedWall);
    }
    EXPECT_EQ(IlluminantAdaptation()(kGreenWall), kGreenWall);
    EXPECT_EQ(AdaptationTable()(kGreenWall), kGreenWall);
    EXPECT_FALSE(IlluminantAdaptation(kCornellLight).is_identity());
}

TEST(SceneIlluminantAdaptation, BrightnessOfTheLightDoesNotMatter) {
    EXPECT_LT(largest_difference(IlluminantAdaptation(kCornellLight)(kRedWall),
                                 IlluminantAdaptation(1000 * kCornellLight)(kRedWall)),
              1e-6f);
}

TEST(SceneIlluminantAdaptation, AgreesWithSpectraOverSeveralBounces) {
    const IlluminantAdaptation adaptation(kCornellLight);
    const float scale = 2 * max_component(kCornellLight);
    const SigmoidSpectrum light = sigmoid_spectrum(kCornellLight / scale);
    for (const std::string path :
         {"W", "R", "G", "WW", "RW", "GW", "WWW", "WRW", "WGW", "WWWW", "WWRW", "WWGW"}) {
        std::vector<SigmoidSpectrum> factors{light};
        Rgb adapted = kCornellLight, plain = kCornellLight;
        for (const char wall : path) {
            const Rgb c = wall == 'W' ? kWhiteWall : (wall == 'R' ? kRedWall : kGreenWall);
            factors.push_back(sigmoid_spectrum(c));
            adapted = adapted * adaptation(c);
            plain = plain * c;
        }
        const Rgb expected = scale * product_colour(factors);
        const float size = max_component(expected);
        EXPECT_LT(largest_difference(adapted, expected), 0.01f * size) << path;
        for (int c = 0; c < 3; ++c)  // faint channels too, among white walls
            if (path.find_first_not_of('W') == std::string::npos) {
                EXPECT_NEAR(adapted[c] / expected[c], 1, 0.01) << path;
            }
        if (path.size() == 1) {
            EXPECT_LT(largest_difference(adapted, expected), 1e-5f * size) << path;
            EXPECT_GT(largest_difference(plain, expected), 1e-3f * size) << path;
        }
    }
}

TEST(SceneIlluminantAdaptation, GreysStayExactly) {
    const IlluminantAdaptation adaptation(kCandle);
    const AdaptationTable table(adaptation);
    for (const float v : {0.0f, 0.003f, 0.18f, 0.5f, 0.77f, 1.0f}) {
        EXPECT_EQ(adaptation(Rgb(v)), Rgb(v));
        EXPECT_EQ(table(Rgb(v)), Rgb(v));
    }
    EXPECT_LT(largest_difference(table({0.5f, 0.5001f, 0.5f}), {0.5f, 0.5001f, 0.5f}), 2e-4f);
}

TEST(SceneIlluminantAdaptation, TableAgreesWithTheFit) {
    for (const Rgb light : {kCornellLight, kCandle, Rgb{0.6f, 0.8f, 1}}) {
        const IlluminantAdaptation adaptation(light);
        const AdaptationTable table(adaptation);
        Rng rng(7);
        for (int i = 0; i < 4000; ++i) {
            const Rgb c = random_colour(rng);
            ASSERT_LT(largest_difference(table(c), adaptation(c)), 0.005f)
                << c.r << " " << c.g << " " << c.b;
        }
    }
}

TEST(SceneIlluminantAdaptation, ExtremesAreSafe) {
    for (const Rgb light : {Rgb{1, 0, 0}, Rgb{0, 1, 0}, Rgb{0, 0, 1}, Rgb{0, 1, 1}, kCandle,
                            Rgb{1e30f, 1e-30f, 1}, Rgb{1, -1, 0.5f}}) {
        const IlluminantAdaptation adaptation(light);
        const AdaptationTable table(adaptation);
        for (const float r : {-1.0f, 0.0f, 1e-7f, 0.5f, 1.0f, 3.0f, NAN, kInfinity})
            for (const float g : {0.0f, 1e-4f, 1.0f, NAN})
                for (const float b : {0.0f, 0.3f, 1.0f}) {
                    for (const Rgb out : {adaptation({r, g, b}), table({r, g, b})})
                        for (int c = 0; c < 3; ++c) {
                            ASSERT_GE(out[c], 0) << r << " " << g << " " << b;
                            ASSERT_LE(out[c], 1) << r << " " << g << " " << b;
                        }
                }
        EXPECT_EQ(adaptation({NAN, 0, 0}), Rgb{});
        EXPECT_EQ(table({NAN, 0, 0}), Rgb{});
    }
}

RC_GTEST_PROP(SceneIlluminantAdaptation, BrighterSurfacesStayBrighter, ()) {
    static const IlluminantAdaptation adaptation(kCornellLight);
    const auto channel = rc::gen::map(rc::gen::inRange(0, 1001), [](int i) { return i * 1e-3f; });
    const Rgb c{*channel, *channel, *channel};
    const float factor = *channel;
    RC_ASSERT(luminance(adaptation(factor * c)) <= luminance(adaptation(c)) + 1e-4f);
}

TEST(SceneIlluminantAdaptation, TheNumberOfThreadsDoesNotMatter) {
    const IlluminantAdaptation adaptation(kCandle);
    const auto sums = [&](int threads) {
        const ThreadLimit limit(threads);
        const AdaptationTable table(adaptation);
        Rng rng(3);
        std::vector<Rgb> values;
        for (int i = 0; i < 1000; ++i) values.push_back(table(random_colour(rng)));
        return values;
    };
    EXPECT_EQ(sums(1), sums(4));
}

}  // namespace
}  // namespace covtrace::test
