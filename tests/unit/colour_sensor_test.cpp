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
/// of its spectrum with a sensor. Computed by nanometres from 360 to 830 with the tables of the
/// CIE, pbrt's unrounded curves and patches of the colour checker, whose end values go on outside.
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
         {{1, 1, 1}, {0.9917f, 0.993f, 0.9857f}},
         {{1.0002f, 1, 0.9995f}, {0.992f, 0.993f, 0.9853f}},
         {{{0.5479f, 0.2989f, 0.2172f}, {0.5485f, 0.3197f, 0.2351f}},
          {{0.1042f, 0.1498f, 0.0523f}, {0.1087f, 0.1445f, 0.0478f}},
          {{0.0231f, 0.0497f, 0.2902f}, {0.0206f, 0.0388f, 0.2853f}},
          {{0.4301f, 0.0324f, 0.0401f}, {0.4486f, 0.0452f, 0.0538f}},
          {{0.8567f, 0.5744f, 0.0086f}, {0.8588f, 0.5678f, 0.0038f}}}},
        {"nikon_d850",
         5000,
         {{1, 1, 1}, {0.7969f, 1.0115f, 1.3016f}},
         {{1.1765f, 0.9756f, 0.7215f}, {0.9806f, 0.9978f, 0.9783f}},
         {{{0.5479f, 0.2989f, 0.2172f}, {0.481f, 0.3186f, 0.3203f}},
          {{0.1042f, 0.1498f, 0.0523f}, {0.0885f, 0.1509f, 0.0656f}},
          {{0.4301f, 0.0324f, 0.0401f}, {0.3955f, 0.0412f, 0.0726f}},
          {{0.8567f, 0.5744f, 0.0086f}, {0.7394f, 0.5878f, 0.0247f}},
          {{0.6392f, 0.2875f, 0.1549f}, {0.5697f, 0.3089f, 0.246f}},
          {{0.1242f, 0.1457f, 0.0352f}, {0.1074f, 0.1472f, 0.0458f}},
          {{0.0299f, 0.0506f, 0.2169f}, {0.0094f, 0.0424f, 0.2809f}},
          {{0.4985f, 0.0274f, 0.0265f}, {0.4628f, 0.0384f, 0.0607f}},
          {{0.9831f, 0.5584f, -0.0118f}, {0.8538f, 0.5713f, 0.0016f}}}},
        {"sony_ilce_9",
         3200,
         {{1, 1, 1}, {0.3557f, 1.1371f, 2.5906f}},
         {{1.6796f, 0.866f, 0.3259f}, {0.978f, 1.0022f, 0.9896f}},
         {{{0.5479f, 0.2989f, 0.2172f}, {0.3022f, 0.3507f, 0.6201f}},
          {{0.1042f, 0.1498f, 0.0523f}, {0.047f, 0.1724f, 0.1457f}},
          {{0.89f, 0.2477f, 0.0631f}, {0.5739f, 0.295f, 0.2518f}},
          {{0.1806f, 0.1294f, 0.0111f}, {0.1079f, 0.1491f, 0.0471f}},
          {{0.0533f, 0.0454f, 0.1112f}, {0.0058f, 0.0523f, 0.2676f}},
          {{1.3307f, 0.5017f, -0.0432f}, {0.8542f, 0.575f, 0.0009f}}}},
    };
    return all;
}

TEST(Sensor, WhiteUnderBothLightsIsPbrts) {
    for (const Case& c : cases()) {
        const auto m = sensor_matrices(*find_sensor(c.sensor), c.kelvin).shown;
        for (const Shown& white : {c.white, c.balanced_white}) {
            const Rgb got = shown(m, white.seen);
            EXPECT_LT(largest_difference(got, white.through), 0.003f * max_component(white.through))
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
    for (const Known& k : {Known{"nikon_d850", {0.3728f, 0.8497f, 0.688f}},
                           Known{"sony_ilce_9", {0.3552f, 0.9444f, 0.7278f}},
                           Known{"canon_eos_100d", {0.4171f, 0.9679f, 0.722f}}})
        for (const float kelvin : {6500.0f, 3200.0f}) {
            const SensorMatrices m = sensor_matrices(*find_sensor(k.sensor), kelvin);
            const Rgb got = shown(m.values, shown(m.shown, Rgb(1)));
            EXPECT_LT(largest_difference(got, k.of_d65), 0.003f * max_component(k.of_d65))
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
         {Fire{1500, {{3.2647f, 0.4342f, 0}, {3.3565f, 0.5057f, 0.0748f}}, 0.002f},
          Fire{2500, {{2.0678f, 0.7695f, 0.1396f}, {2.0299f, 0.7945f, 0.2088f}}, 0.001f}}) {
        const Rgb through = fire.shown.through, got = shown(matrices.shown, fire.shown.seen);
        EXPECT_LT(largest_difference(got, through), 0.04f * max_component(through))
            << got.r << " " << got.g << " " << got.b;
        // Light itself, given for the sensor, is exact where no component is below 0
        const Rgb of_light = shown(matrices.shown, light.blackbody_colour(fire.kelvin));
        EXPECT_LT(largest_difference(of_light, through), fire.within * max_component(through))
            << of_light.r << " " << of_light.g << " " << of_light.b;
        if (fire.kelvin > 2000) {
            EXPECT_NEAR(of_light.b, through.b, 0.002f * through.b);
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
        // The spectrum, of a table with three digits, has that colour.
        const Triple light = product(inverse(kXyzFromRec709), w);
        const Rgb c = emission_colour(daylight_spectrum(k.kelvin));
        for (int i = 0; i < 3; ++i) EXPECT_NEAR(c[i], light[static_cast<size_t>(i)], 2e-3) << i;
    }
}

}  // namespace
}  // namespace covtrace::test
