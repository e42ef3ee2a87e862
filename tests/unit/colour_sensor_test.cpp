/// Sensors as matrices, against pbrt-v4's treatment of spectra.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "colour/daylight.h"
#include "colour/sensor_matrix.h"
#include "pbrt_test_support.h"

namespace covtrace::test {
namespace {

Rgb shown(const std::array<std::array<float, 3>, 3>& m, Rgb c) {
    Rgb r;
    for (int i = 0; i < 3; ++i) {
        const auto& row = m[static_cast<size_t>(i)];
        r[i] = row[0] * c.r + row[1] * c.g + row[2] * c.b;
    }
    return r;
}

float largest_difference(Rgb a, Rgb b) {
    return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
}

/// A surface under a light: its colour to the standard observer, and what pbrt-v4's formulas make
/// of its spectrum with a sensor. Computed by nanometres with the tables of the CIE, pbrt's
/// unrounded curves and patches of the colour checker.
struct Shown {
    Rgb seen, through;
};
struct Case {
    const char* sensor;
    float kelvin;
    Shown white, balanced_white;  ///< a white surface under D65, under the light of the balance
    std::vector<Shown> surfaces;  ///< skin, foliage, blue, red, yellow under both lights
};

const std::vector<Case>& cases() {
    static const std::vector<Case> all{
        {"canon_eos_5d_mkiv",
         6500,
         {{1, 1, 1}, {0.9918f, 0.993f, 0.985f}},
         {{0.9999f, 1, 1.0001f}, {0.9918f, 0.993f, 0.9851f}},
         {{{0.5477f, 0.299f, 0.2172f}, {0.5483f, 0.3197f, 0.2347f}},
          {{0.1041f, 0.1498f, 0.0522f}, {0.1086f, 0.1445f, 0.0478f}},
          {{0.0231f, 0.0497f, 0.2902f}, {0.0207f, 0.0388f, 0.2852f}},
          {{0.4299f, 0.0324f, 0.0401f}, {0.4482f, 0.0452f, 0.0536f}},
          {{0.8564f, 0.5745f, 0.0086f}, {0.8589f, 0.5678f, 0.0037f}}}},
        {"nikon_d850",
         5000,
         {{1, 1, 1}, {0.7978f, 1.0118f, 1.3006f}},
         {{1.176f, 0.9757f, 0.7221f}, {0.9809f, 0.998f, 0.9783f}},
         {{{0.5477f, 0.299f, 0.2172f}, {0.481f, 0.3185f, 0.3199f}},
          {{0.1041f, 0.1498f, 0.0522f}, {0.0884f, 0.1509f, 0.0654f}},
          {{0.4299f, 0.0324f, 0.0401f}, {0.3952f, 0.0411f, 0.0722f}},
          {{0.8564f, 0.5745f, 0.0086f}, {0.7395f, 0.5878f, 0.0245f}},
          {{0.6386f, 0.2875f, 0.155f}, {0.5692f, 0.3089f, 0.2457f}},
          {{0.124f, 0.1457f, 0.0353f}, {0.1073f, 0.1472f, 0.0457f}},
          {{0.0298f, 0.0506f, 0.2171f}, {0.0095f, 0.0425f, 0.281f}},
          {{0.498f, 0.0275f, 0.0265f}, {0.462f, 0.0382f, 0.0602f}},
          {{0.9824f, 0.5585f, -0.0118f}, {0.8535f, 0.5713f, 0.0015f}}}},
        {"sony_ilce_9",
         3200,
         {{1, 1, 1}, {0.3584f, 1.1373f, 2.5906f}},
         {{1.6788f, 0.8661f, 0.3264f}, {0.9783f, 1.0023f, 0.99f}},
         {{{0.5477f, 0.299f, 0.2172f}, {0.3031f, 0.3508f, 0.6204f}},
          {{0.1041f, 0.1498f, 0.0522f}, {0.0471f, 0.1724f, 0.1455f}},
          {{0.8889f, 0.2478f, 0.0632f}, {0.5736f, 0.295f, 0.2514f}},
          {{0.1804f, 0.1294f, 0.0111f}, {0.1078f, 0.149f, 0.0469f}},
          {{0.0532f, 0.0454f, 0.1113f}, {0.006f, 0.0524f, 0.2677f}},
          {{1.3294f, 0.5018f, -0.0432f}, {0.8539f, 0.575f, 0.0007f}}}},
    };
    return all;
}

TEST(Sensor, WhiteUnderBothLightsIsPbrts) {
    for (const Case& c : cases()) {
        const auto m = sensor_matrices(*find_sensor(c.sensor), c.kelvin).shown;
        for (const Shown& white : {c.white, c.balanced_white}) {
            const Rgb got = shown(m, white.seen);
            EXPECT_LT(largest_difference(got, white.through), 0.01f * max_component(white.through))
                << c.sensor << " " << got.r << " " << got.g << " " << got.b;
        }
    }
}

TEST(Sensor, SurfacesAreNearThoseOfSpectra) {
    for (const Case& c : cases()) {
        const auto m = sensor_matrices(*find_sensor(c.sensor), c.kelvin).shown;
        for (const Shown& s : c.surfaces) {
            const Rgb got = shown(m, s.seen);
            EXPECT_LT(largest_difference(got, s.through), 0.15f * max_component(s.through))
                << c.sensor << " " << s.seen.r << ": " << got.r << " " << got.g << " " << got.b;
        }
    }
}

TEST(Sensor, AllOfThemShowTheirBalanceAlmostWhite) {
    const std::vector<std::string> names = sensor_names();
    EXPECT_EQ(names.size(), 18u);
    for (const std::string& name : names) {
        const SensorCurves* sensor = find_sensor(name);
        ASSERT_EQ(sensor == nullptr, name == "cie1931");
        if (!sensor) continue;
        for (const float kelvin : {2500.0f, 4500.0f, 6500.0f, 12000.0f}) {
            const Triple xyz = daylight_white(kelvin);
            const Triple light = product(inverse(kXyzFromRec709), xyz);
            const Rgb got = shown(sensor_matrices(*sensor, kelvin).shown,
                                  {static_cast<float>(light[0]), static_cast<float>(light[1]),
                                   static_cast<float>(light[2])});
            EXPECT_LT(largest_difference(got, Rgb(1)), 0.06f)
                << name << " " << kelvin << ": " << got.r << " " << got.g << " " << got.b;
        }
    }
}

TEST(Sensor, ValuesAreTheIntegralsOfItsCurves) {
    // Integrals, by nanometres, of pbrt's curves times D65 over that of the CIE's y times D65.
    struct Known {
        const char* sensor;
        Rgb of_d65;
    };
    for (const Known& k : {Known{"nikon_d850", {0.3717f, 0.8486f, 0.6868f}},
                           Known{"sony_ilce_9", {0.3548f, 0.9439f, 0.7273f}},
                           Known{"canon_eos_100d", {0.416f, 0.9669f, 0.721f}}})
        for (const float kelvin : {6500.0f, 3200.0f}) {
            const SensorMatrices m = sensor_matrices(*find_sensor(k.sensor), kelvin);
            const Rgb got = shown(m.values, shown(m.shown, Rgb(1)));
            EXPECT_LT(largest_difference(got, k.of_d65), 0.01f * max_component(k.of_d65))
                << k.sensor << " " << got.r << " " << got.g << " " << got.b;
        }
}

TEST(Sensor, FireIsNearThatOfSpectra) {
    // Black bodies of 1500 and 2500 K, by pbrt-v4's formulas. The blue of the first one is below 0,
    // for the sensor as for the standard observer.
    struct Fire {
        double kelvin;
        Shown shown;
        float within;
    };
    const SensorCurves& sensor = *find_sensor("nikon_d850");
    const SensorMatrices matrices = sensor_matrices(sensor, 6000);
    const SensorLight light(sensor, matrices);
    for (const Fire& fire :
         {Fire{1500, {{3.264f, 0.4342f, 0}, {3.2776f, 0.484f, 0.0328f}}, 0.013f},
          Fire{2500, {{2.0676f, 0.7694f, 0.1396f}, {2.0195f, 0.7918f, 0.2036f}}, 0.008f}}) {
        const Rgb through = fire.shown.through, got = shown(matrices.shown, fire.shown.seen);
        EXPECT_LT(largest_difference(got, through), 0.025f * max_component(through))
            << got.r << " " << got.g << " " << got.b;
        // Light itself, given for the sensor, is exact where no component is below 0, but for the
        // fit of the standard observer
        const Rgb of_light = shown(matrices.shown, light.blackbody_colour(fire.kelvin));
        EXPECT_LT(largest_difference(of_light, through), fire.within * max_component(through))
            << of_light.r << " " << of_light.g << " " << of_light.b;
        if (fire.kelvin > 2000) {
            EXPECT_NEAR(of_light.b, through.b, 0.005f * through.b);
        }
    }
}

TEST(Daylight, HasTheChromaticityThatItIsNamedBy) {
    // Standard illuminants D50 and D65 (CIE 15:2004), whose temperatures are of the old constant
    // c2.
    struct Known {
        double kelvin, x, y;
    };
    for (const Known& k : {Known{5000, 0.3457, 0.3585}, Known{6500, 0.3127, 0.3290}}) {
        const Triple w = daylight_white(k.kelvin);
        const double sum = w[0] + w[1] + w[2];
        EXPECT_NEAR(w[0] / sum, k.x, 2e-4);
        EXPECT_NEAR(w[1] / sum, k.y, 2e-4);
        // The spectrum has that colour, up to the fit of the matching functions.
        const Triple light = product(inverse(kXyzFromRec709), w);
        const Rgb c = emission_colour(daylight_spectrum(k.kelvin));
        for (int i = 0; i < 3; ++i) EXPECT_NEAR(c[i], light[static_cast<size_t>(i)], 0.01) << i;
    }
}

}  // namespace
}  // namespace covtrace::test
