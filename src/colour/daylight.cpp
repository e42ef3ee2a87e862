#include "colour/daylight.h"

#include <algorithm>

namespace covtrace {

namespace {

constexpr double kFirst = 360, kStep = 10;
constexpr size_t kSamples = 48;
/// Components of daylight: the mean spectrum of the sky, its change from blue to yellow and that
/// from pink to green (CIE 15:2004, table T.2).
constexpr std::array<std::array<double, kSamples>, 3> kComponents{
    {{61.5,  68.8,  63.4,  65.8,  94.8,  104.8, 105.9, 96.8,  113.9, 125.6, 125.5, 121.3,
      121.3, 113.5, 113.1, 110.8, 106.5, 108.8, 105.3, 104.4, 100.0, 96.0,  95.1,  89.1,
      90.5,  90.3,  88.4,  84.0,  85.1,  81.9,  82.6,  84.9,  81.3,  71.9,  74.3,  76.4,
      63.3,  71.7,  77.0,  65.2,  47.7,  68.6,  65.0,  66.0,  61.0,  53.3,  58.9,  61.9},
     {38.0,  42.4,  38.5,  35.0,  43.4,  46.3,  43.9,  37.1,  36.7,  35.9,  32.6,  27.9,
      24.3,  20.1,  16.2,  13.2,  8.6,   6.1,   4.2,   1.9,   0.0,   -1.6,  -3.5,  -3.5,
      -5.8,  -7.2,  -8.6,  -9.5,  -10.9, -10.7, -12.0, -14.0, -13.6, -12.0, -13.3, -12.9,
      -10.6, -11.6, -12.2, -10.2, -7.8,  -11.2, -10.4, -10.6, -9.7,  -8.3,  -9.3,  -9.8},
     {5.3,  6.1,  3.0,  1.2,  -1.1, -0.5, -0.7, -1.2, -2.6, -2.9, -2.8, -2.6,
      -2.6, -1.8, -1.5, -1.3, -1.2, -1.0, -0.5, -0.3, 0.0,  0.2,  0.5,  2.1,
      3.2,  4.1,  4.7,  5.1,  6.7,  7.3,  8.6,  9.8,  10.2, 8.3,  9.6,  8.5,
      7.0,  7.6,  8.0,  6.7,  5.2,  7.4,  6.8,  7.0,  6.4,  5.5,  6.1,  6.5}}};

/// The temperature by today's radiation constant c2.
double today(double kelvin) {
    return kelvin * 1.4388 / 1.4380;
}
constexpr double kCoolestDaylight = 4000;

struct Chromaticity {
    double x, y;
};
Chromaticity chromaticity(double t) {
    const double x = t <= 7000
                         ? -4.6070e9 / (t * t * t) + 2.9678e6 / (t * t) + 0.09911e3 / t + 0.244063
                         : -2.0064e9 / (t * t * t) + 1.9018e6 / (t * t) + 0.24748e3 / t + 0.237040;
    return {x, -3 * x * x + 2.870 * x - 0.275};
}

}  // namespace

Triple daylight_white(double kelvin) {
    const double t = today(kelvin);
    if (t < kCoolestDaylight) {
        const Rgb c = emission_colour(blackbody_spectrum(t));
        return product(kXyzFromRec709, Triple{c.r, c.g, c.b});
    }
    const auto [x, y] = chromaticity(t);
    return {x / y, 1, (1 - x - y) / y};
}

Spectrum daylight_spectrum(double kelvin) {
    const double t = today(kelvin);
    if (t < kCoolestDaylight) return blackbody_spectrum(t);
    const auto [x, y] = chromaticity(t);
    const double m = 0.0241 + 0.2562 * x - 0.7341 * y;
    const double yellow = (-1.3515 - 1.7703 * x + 5.9114 * y) / m;
    const double pink = (0.0300 - 31.4424 * x + 30.0717 * y) / m;
    Spectrum s;
    for (size_t i = 0; i < kSamples; ++i) {
        s.wavelengths.push_back(static_cast<float>(kFirst + kStep * static_cast<double>(i)));
        const double v = kComponents[0][i] + yellow * kComponents[1][i] + pink * kComponents[2][i];
        // Very cold daylight would be negative in the red.
        s.values.push_back(static_cast<float>(std::max(0.0, v)));
    }
    return s;
}

}  // namespace covtrace
