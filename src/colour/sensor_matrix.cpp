#include "colour/sensor_matrix.h"

#include <algorithm>
#include <vector>

#include "colour/chart_reflectances.h"
#include "colour/daylight.h"
#include "colour/matrix3.h"
#include "colour/sigmoid_spectrum.h"
#include "colour/spectrum.h"

namespace covtrace {

namespace {

/// Wavelengths that a sensor sees, in steps of kObserverStep, with what light there adds to the
/// observer's colour. They reach farther than the observer's own, as pbrt's do: a sensor of which
/// a little is left in the infrared sees much of it in fire.
const std::vector<ObserverSample>& wavelengths() {
    static const std::vector<ObserverSample> all = [] {
        constexpr int kFirst = 360, kLast = 830;
        std::vector<ObserverSample> list;
        for (int l = kFirst; l <= kLast; l += kObserverStep) list.push_back({double(l), {}});
        for (const ObserverSample& seen : observer_samples())
            list[static_cast<size_t>(seen.wavelength - kFirst) / kObserverStep] = seen;
        return list;
    }();
    return all;
}

/// Values at wavelengths().
using Samples = std::vector<double>;

/// A measurement at 380, 390, ... nm, linear between them; its end values go on outside, as pbrt
/// has it.
template <size_t Count>
double interpolated(const std::array<uint16_t, Count>& table, double unit, double wavelength) {
    constexpr double kFirst = 380, kStep = 10;
    const double x = std::clamp((wavelength - kFirst) / kStep, 0.0, double(Count - 1));
    const auto i = std::min(static_cast<size_t>(x), Count - 2);
    const double t = x - static_cast<double>(i);
    return unit * ((1 - t) * table[i] + t * table[i + 1]);
}

template <typename Function>
Samples sampled(Function f) {
    Samples s;
    for (const ObserverSample& w : wavelengths()) s.push_back(f(w.wavelength));
    return s;
}

double luminance_of(const Triple& c) {
    return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
}

/// Light of which the part `factor` arrives, both at wavelengths().
class Eye {
  public:
    explicit Eye(const SensorCurves& sensor) {
        for (size_t c = 0; c < 3; ++c)
            curves_[c] = sampled([&](double l) { return interpolated(sensor.values[c], 1e-4, l); });
        d65_ = sampled([s = daylight_spectrum(6500)](double l) { return s.at(l); });
    }
    const Samples& d65() const { return d65_; }
    /// Linear Rec.709 of the standard observer, white for D65.
    Triple colour(const Samples& light, const Samples& factor) const {
        Triple sum{};
        for (size_t i = 0; i < light.size(); ++i)
            for (size_t c = 0; c < 3; ++c)
                sum[c] += wavelengths()[i].weight[c] * factor[i] * light[i] / d65_[i];
        return sum;
    }
    /// Integral of D65 and CIE's y over nanometres.
    double luminance_of_d65() const {
        double relative = 0;
        for (size_t i = 0; i < d65_.size(); ++i)
            relative += luminance_of(wavelengths()[i].weight) / d65_[i];
        return kLuminanceOfOne / relative;
    }
    /// The sensor's three values, the integrals over nanometres divided by kObserverStep.
    Triple response(const Samples& light, const Samples& factor) const {
        Triple sum{};
        for (size_t i = 0; i < light.size(); ++i)
            for (size_t c = 0; c < 3; ++c) sum[c] += curves_[c][i] * factor[i] * light[i];
        return sum;
    }

  private:
    std::array<Samples, 3> curves_;
    Samples d65_;
};

std::vector<Samples> patches() {
    std::vector<Samples> list;
    for (const ChartReflectance& patch : chart_reflectances())
        list.push_back(sampled([&](double l) { return interpolated(patch, 1e-3, l); }));
    return list;
}

/// Smooth spectra of colours all over Rec.709.
std::vector<Samples> smooth_spectra() {
    constexpr std::array<float, 3> kLevels{0.05f, 0.35f, 0.8f};
    std::vector<Samples> list;
    for (const float r : kLevels)
        for (const float g : kLevels)
            for (const float b : kLevels)
                list.push_back(
                    sampled([s = sigmoid_spectrum({r, g, b})](double l) { return s.at(l); }));
    return list;
}

}  // namespace

SensorMatrices sensor_matrices(const SensorCurves& sensor, float kelvin) {
    const Eye eye(sensor);
    const Samples balanced = sampled([s = daylight_spectrum(kelvin)](double l) { return s.at(l); });
    const Samples white(balanced.size(), 1);

    // pbrt's matrix, times the one from XYZ to Rec.709
    LeastSquares calibration;
    const double brightness = luminance_of(eye.colour(balanced, white));
    for (const Samples& patch : patches()) {
        Triple target = eye.colour(eye.d65(), patch);
        for (double& c : target) c *= brightness;
        calibration.add(eye.response(balanced, patch), target);
    }
    const Matrix3 from_sensor = calibration.solve();

    // The image's colours in place of the sensor's. Light itself, which greys show, counts so much
    // that it is left as pbrt shows it.
    constexpr double kWeightOfWhite = 1000;
    std::vector<Samples> spectra = patches();
    for (Samples& s : smooth_spectra()) spectra.push_back(std::move(s));
    LeastSquares whole;
    for (const Samples* light : {&eye.d65(), &balanced}) {
        const double scale = 1 / luminance_of(eye.colour(*light, white));
        const auto add = [&](const Samples& factor, double weight) {
            whole.add(eye.colour(*light, factor),
                      product(from_sensor, eye.response(*light, factor)), weight * scale * scale);
        };
        add(white, kWeightOfWhite);
        for (const Samples& factor : spectra) add(factor, 1);
    }
    // Fire and lamps, whose blue is small beside their red.
    for (const double glowing : {1500.0, 2000.0, 2850.0}) {
        const Samples light =
            sampled([s = blackbody_spectrum(glowing)](double l) { return s.at(l); });
        const double scale = 1 / luminance_of(eye.colour(light, white));
        whole.add(eye.colour(light, white), product(from_sensor, eye.response(light, white)),
                  sqr(scale));
    }
    Matrix3 values = inverse(from_sensor);
    for (Triple& row : values)
        for (double& v : row) v *= kObserverStep / eye.luminance_of_d65();
    return {single_precision(whole.solve()), single_precision(values)};
}

SensorLight::SensorLight(const SensorCurves& sensor, const SensorMatrices& matrices) {
    const Eye eye(sensor);
    const auto rows = [](const std::array<std::array<float, 3>, 3>& m) {
        Matrix3 r{};
        for (size_t i = 0; i < 3; ++i)
            for (size_t j = 0; j < 3; ++j) r[i][j] = double(m[i][j]);
        return r;
    };
    const Matrix3 from_values = inverse(product(rows(matrices.values), rows(matrices.shown)));
    const double unit = kObserverStep / eye.luminance_of_d65();
    const Samples everywhere(eye.d65().size(), 1);
    for (size_t i = 0; i < everywhere.size(); ++i) {
        Samples line(everywhere.size(), 0);
        line[i] = 1;
        Triple values = eye.response(line, everywhere);
        for (double& v : values) v *= unit;
        colour_.push_back(product(from_values, values));
        luminance_.push_back(luminance_of(eye.colour(line, everywhere)));
    }
}

Rgb SensorLight::blackbody_colour(double kelvin) const {
    const Samples light = sampled([s = blackbody_spectrum(kelvin)](double l) { return s.at(l); });
    Triple colour{};
    double luminance = 0;
    for (size_t i = 0; i < light.size(); ++i) {
        for (size_t c = 0; c < 3; ++c) colour[c] += colour_[i][c] * light[i];
        luminance += luminance_[i] * light[i];
    }
    Rgb result;
    for (int c = 0; c < 3; ++c)
        result[c] = static_cast<float>(std::max(0.0, colour[static_cast<size_t>(c)] / luminance));
    return result;
}

}  // namespace covtrace
