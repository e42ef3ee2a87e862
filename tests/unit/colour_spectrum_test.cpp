#include "colour/sigmoid_spectrum.h"
#include "colour/spectrum.h"

#include <gtest/gtest.h>

#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "colour/named_spectra.h"
#include "pbrt_test_support.h"

namespace covtrace::test {
namespace {

Spectrum constant(float v) {
    return {{380, 780}, {v, v}, true};
}

TEST(SceneSpectrum, InterpolatesLinearly) {
    const Spectrum s{{400, 500, 600}, {1, 3, 2}, false};
    EXPECT_DOUBLE_EQ(s.at(450), 2);
    EXPECT_DOUBLE_EQ(s.at(600), 2);
    EXPECT_DOUBLE_EQ(s.at(399), 0);
    EXPECT_DOUBLE_EQ(s.at(601), 0);
    EXPECT_DOUBLE_EQ((Spectrum{{400, 500}, {1, 3}, true}.at(399)), 1);
    EXPECT_DOUBLE_EQ((Spectrum{{}, {}, true}.at(500)), 0);
    EXPECT_DOUBLE_EQ((Spectrum{{550}, {1.5f}, true}.at(500)), 1.5);
}

TEST(SceneSpectrum, GreySurfacesAreGrey) {
    for (float v : {0.0f, 0.18f, 1.0f}) expect_near(reflectance_colour(constant(v)), Rgb{v}, 1e-6f);
    expect_near(channel_means(constant(1.7f)), Rgb{1.7f}, 1e-5f);
}

RC_GTEST_PROP(SceneSpectrum, ColoursAreLinearInTheSpectrum, ()) {
    const auto value = rc::gen::inRange(0, 1000);
    const auto a = *rc::gen::container<std::vector<int>>(9, value);
    const auto b = *rc::gen::container<std::vector<int>>(9, value);
    Spectrum x, y, sum;
    for (size_t i = 0; i < 9; ++i) {
        for (Spectrum* s : {&x, &y, &sum})
            s->wavelengths.push_back(380 + 50 * static_cast<float>(i));
        x.values.push_back(static_cast<float>(a[i]) / 1000);
        y.values.push_back(static_cast<float>(b[i]) / 1000);
        sum.values.push_back(x.values.back() + y.values.back());
    }
    const Rgb d = reflectance_colour(sum) - reflectance_colour(x) - reflectance_colour(y);
    for (int c = 0; c < 3; ++c) RC_ASSERT(std::abs(d[c]) < 1e-5f);
}

TEST(SceneSpectrum, BlackbodiesHaveTheirKnownChromaticity) {
    // Points of the Planckian locus, CIE 1931 (Robertson's and later tables): 2856 K is illuminant
    // A, 6500 K nearly D65.
    struct Case {
        double kelvin, x, y;
    };
    for (const Case& c :
         {Case{2000, 0.5267, 0.4133}, Case{2856, 0.4476, 0.4074}, Case{4000, 0.3805, 0.3768},
          Case{6500, 0.3135, 0.3237}, Case{10000, 0.2807, 0.2884}}) {
        const Rgb got = emission_colour(blackbody_spectrum(c.kelvin));
        EXPECT_NEAR(luminance(got), 1, 1e-4f);
        // The tables have four digits.
        expect_near(got, chromaticity_colour(c.x, c.y), 0.002f * max_component(got));
    }
    for (double kelvin : {1.0, 50.0, 1e6, 1e9})
        EXPECT_TRUE(is_finite(emission_colour(blackbody_spectrum(kelvin)))) << kelvin;
}

TEST(SceneSpectrum, BlackbodiesAreAsBrightAsTheyAreSeen) {
    // Planck's law over its largest value, seen by CIE's y, over what it sees of light that is 1
    // everywhere: sums over each nanometre from 360 to 830. That light has the luminance
    // 106.856895, the sum of y.
    constexpr double kOne = 106.856895;
    struct Case {
        double kelvin, luminance;
    };
    for (const Case& c : {Case{1500, 0.00340998}, Case{2000, 0.0484839}, Case{3000, 0.416019},
                          Case{5772, 0.962746}, Case{10000, 0.443618}}) {
        EXPECT_NEAR(blackbody_luminance(c.kelvin), kOne * c.luminance, 5e-4 * kOne * c.luminance)
            << c.kelvin;
    }
    for (double kelvin : {1.0, 100.0, 1e6, 1e9})
        EXPECT_TRUE(std::isfinite(blackbody_luminance(kelvin))) << kelvin;
}

TEST(SceneSpectrum, DaylightIsWhite) {
    expect_near(*illuminant_colour("stdillum-D65"), Rgb{1}, 1e-3f);
    EXPECT_FALSE(illuminant_colour("stdillum-D66").has_value());
}

TEST(SceneSpectrum, MonochromaticLightIsSaturated) {
    const auto line = [](float nm) {
        return emission_colour({{nm - 5, nm, nm + 5}, {0, 1, 0}, false});
    };
    EXPECT_GT(line(630).r, 4.0f);
    EXPECT_EQ(line(630).b, 0);
    EXPECT_GT(line(530).g, 1.0f);
    EXPECT_EQ(line(530).r, 0);
    // The line's luminance is 1 before the negative green of such a blue is cut off, as in pbrt's
    // image.
    EXPECT_GT(line(450).b, 40.0f);
    EXPECT_EQ(line(450).g, 0);
    EXPECT_TRUE(is_black(emission_colour({{900, 1000}, {1, 1}, false})));
}

TEST(SceneSpectrum, LinesLieWhereTheyLie) {
    // A line has the colour of its wavelength, however narrow it is and wherever it lies.
    for (const float nm : {435.8f, 546.1f, 589.3f, 611.7f})
        for (const float width : {0.01f, 0.2f, 1.0f}) {
            const Rgb narrow = emission_colour({{nm - width, nm, nm + width}, {0, 1, 0}, false});
            const Rgb line = emission_colour({{nm}, {1}, false});
            // The luminance is 1 together with the negative light of a colour outside Rec.709.
            EXPECT_GE(luminance(line), 1 - 1e-4f);
            expect_near(narrow, line, 0.01f * max_component(line));
        }
    // Two lines beside each other add up by what they hold.
    const Spectrum two{{440, 441, 442, 599, 600, 601}, {0, 1, 0, 0, 1, 0}, false};
    const Spectrum wide{{440, 441, 442, 598, 600, 602}, {0, 1, 0, 0, 0.5f, 0}, false};
    expect_near(emission_colour(two), emission_colour(wide), 0.01f);
}

TEST(SceneSpectrum, NarrowBandsOfAReflectanceCountByTheirWidth) {
    const auto band = [](float from, float to) {
        return reflectance_colour({{from, from + 0.01f, to - 0.01f, to}, {0, 1, 1, 0}, false});
    };
    const Rgb whole = band(551, 561);
    Rgb parts;
    for (float nm = 551; nm < 561; nm += 2.5f) parts += band(nm, nm + 2.5f);
    EXPECT_GT(whole.g, 0.05f);
    expect_near(parts, whole, 0.01f * whole.g);
}

double normal_reflectance(double n, double k) {
    return ((n - 1) * (n - 1) + k * k) / ((n + 1) * (n + 1) + k * k);
}

TEST(SceneSpectrum, ConductorsKeepTheirReflectanceAtNormalIncidence) {
    for (const char* name : {"metal-Ag", "metal-Al", "metal-Au", "metal-Cu", "metal-CuZn",
                             "metal-MgO", "metal-TiO2"}) {
        const Spectrum eta = material_spectrum(std::string(name) + "-eta").value();
        const Spectrum k = material_spectrum(std::string(name) + "-k").value();
        Spectrum reflectance;
        for (float nm = 380; nm <= 780; nm += 5) {
            reflectance.wavelengths.push_back(nm);
            reflectance.values.push_back(
                static_cast<float>(normal_reflectance(eta.at(nm), k.at(nm))));
        }
        const Rgb expected = reflectance_colour(reflectance);
        const ConductorColours c = conductor_colours(eta, k, channel_means(eta));
        for (int i = 0; i < 3; ++i) {
            EXPECT_NEAR(normal_reflectance(c.eta[i], c.k[i]), std::min(expected[i], 0.9999f), 1e-4)
                << name;
            EXPECT_GE(c.k[i], 0);
            EXPECT_GT(c.eta[i], 0);
        }
    }
}

TEST(SceneSpectrum, NamedSpectraAreListed) {
    for (const std::string& name : spectrum_names())
        EXPECT_TRUE(material_spectrum(name).has_value() || illuminant_colour(name).has_value())
            << name;
    // Index at the helium d line and Abbe's number of SF11, by Schott.
    const Spectrum sf11 = *material_spectrum("glass-F11");
    EXPECT_NEAR(sf11.at(587.6), 1.7847, 2e-4);
    EXPECT_NEAR((sf11.at(587.6) - 1) / (sf11.at(486.1) - sf11.at(656.3)), 25.7, 0.15);
}

TEST(SceneSpectrum, FilesHoldPairsAndComments) {
    const TemporaryFolder folder;
    const auto file = folder.write("my white.spd", "# grey\n300 .25\n900 .25 # end\n");
    const std::string text =
        "WorldBegin\nMaterial \"diffuse\" \"spectrum reflectance\" \"my white.spd\"\nShape "
        "\"sphere\"";
    const auto scene = read_pbrt_string(text, "t.pbrt", folder.path());
    const auto& m = scene.materials.at(static_cast<size_t>(scene.shapes.at(0).material)).value;
    expect_near(constant_value(scene, std::get<DiffuseMaterial>(m).reflectance), Rgb{0.25f}, 1e-5f);
    folder.write("my white.spd", "300 .25\n900 x\n");
    const Failure f = failure_of([&] { read_pbrt_string(text, "t.pbrt", folder.path()); });
    EXPECT_EQ(f.message, file.string() + ":2:5: expected a number, found \"x\"");
}

/// White light after a ball of radius 2 of an absorbing medium, seen by parallel rays over the
/// square [-1, 1]^2: with a coefficient per channel, and with pbrt-v4's spectrum for it.
struct Absorbed {
    std::array<double, 3> channels{}, spectral{};
};
Absorbed absorbed(Rgb coefficient) {
    const Spectrum spectrum = unbounded_spectrum(coefficient);
    Absorbed a;
    constexpr int n = 16;
    for (int i = 0; i < n * n; ++i) {
        const double x = (i % n + 0.5) / n, y = (i / n + 0.5) / n;
        const double chord = 2 * std::sqrt(4 - x * x - y * y);
        for (int c = 0; c < 3; ++c)
            a.channels[size_t(c)] += std::exp(-coefficient[c] * chord) / (n * n);
        for (const ObserverSample& s : observer_samples())
            for (size_t c = 0; c < 3; ++c)
                a.spectral[c] +=
                    s.weight[c] * std::exp(-spectrum.at(s.wavelength) * chord) / (n * n);
    }
    return a;
}

// The colours of media differ from pbrt-v4's, as attenuation is exponential, wavelength by
// wavelength, and three numbers are not a spectrum. The ratios are those of pbrt's renders of the
// same ball (256 samples per pixel, docs/decisions/0019), channels below 0.01 left out.
TEST(Spectrum, AbsorptionByChannelsIsNotThatOfASpectrum) {
    struct Case {
        Rgb coefficient;
        std::array<double, 3> ratio;  // ratio of channels over pbrt's; 0: not compared
    };
    for (const Case& k :
         {Case{{0.1f, 0.5f, 2}, {1.234, 1.130, 0}}, Case{{2, 0.5f, 0.1f}, {0, 1.022, 1.159}},
          Case{{0.5f, 0.2f, 0.05f}, {1.415, 1.002, 1.021}}}) {
        const Absorbed a = absorbed(k.coefficient);
        for (size_t c = 0; c < 3; ++c) {
            if (!(k.ratio[c] > 0)) continue;
            EXPECT_NEAR(a.channels[c] / a.spectral[c], k.ratio[c], 0.02) << "channel " << c;
        }
    }
    // A grey medium has no such trouble.
    const Absorbed grey = absorbed(Rgb(0.5f));
    for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(grey.channels[c], grey.spectral[c], 1e-6);
}

TEST(SceneSpectrum, ABlackbodysScaleOfVersionThreeIsTold) {
    const auto colour = [](const std::string& numbers) {
        const auto scene =
            read_world("LightSource \"infinite\" \"blackbody L\" [ " + numbers + " ]");
        return std::pair(std::get<InfiniteLight>(scene.lights.at(0).value).radiance,
                         warnings_of(scene));
    };
    const auto [one, silent] = colour("6000");
    const auto [both, told] = colour("6000 3");
    EXPECT_EQ(one, both);
    EXPECT_EQ(silent, "");
    EXPECT_NE(told.find("a scale in pbrt-v3, is ignored"), std::string::npos) << told;
}

}  // namespace
}  // namespace covtrace::test
