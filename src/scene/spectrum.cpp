#include "scene/spectrum.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace covtrace {

namespace {

struct Xyz {
    double x = 0, y = 0, z = 0;
};
struct Rgb64 {
    std::array<double, 3> c{};
};

constexpr int kFirst = 380, kLast = 780, kStep = 5;
constexpr size_t kSamples = (kLast - kFirst) / kStep + 1;

// CIE standard illuminant D65, relative power every 10 nm from 380 to 780 (CIE 15:2004, table T.1).
constexpr std::array<double, 41> kD65{49.9755, 54.6482, 82.7549, 91.486,  93.4318, 86.6823, 104.865,
                                      117.008, 117.812, 114.861, 115.923, 108.811, 109.354, 107.802,
                                      104.79,  107.689, 104.405, 104.046, 100.0,   96.3342, 95.788,
                                      88.6856, 90.0062, 89.5991, 87.6987, 83.2886, 83.6992, 80.0268,
                                      80.2146, 82.2778, 78.2842, 69.7213, 71.6091, 74.349,  61.604,
                                      69.8856, 75.087,  63.5927, 46.4182, 66.8054, 63.3828};

double lobe(double wavelength, double centre, double below, double above) {
    const double t = (wavelength - centre) / (wavelength < centre ? below : above);
    return std::exp(-0.5 * t * t);
}

Xyz matching(double l) {
    return {1.056 * lobe(l, 599.8, 37.9, 31.0) + 0.362 * lobe(l, 442.0, 16.0, 26.7) -
                0.065 * lobe(l, 501.1, 20.4, 26.2),
            0.821 * lobe(l, 568.8, 46.9, 40.5) + 0.286 * lobe(l, 530.9, 16.3, 31.1),
            1.217 * lobe(l, 437.0, 11.8, 36.0) + 0.681 * lobe(l, 459.0, 26.0, 13.8)};
}

/// From the primaries and the white point of ITU-R BT.709.
Rgb64 rec709(const Xyz& v) {
    return {{3.2409699419 * v.x - 1.5373831776 * v.y - 0.4986107603 * v.z,
             -0.9692436363 * v.x + 1.8759675015 * v.y + 0.0415550574 * v.z,
             0.0556300797 * v.x - 0.2039769589 * v.y + 1.0569715142 * v.z}};
}

/// What each wavelength adds to the colour, scaled so that D65 gives (1, 1, 1).
struct Observer {
    std::array<Rgb64, kSamples> response{};
    std::array<double, kSamples> d65{};
    std::array<ObserverSample, kSamples> samples{};
    Observer() {
        Rgb64 white;
        for (size_t i = 0; i < kSamples; ++i) {
            d65[i] = i % 2 == 0 ? kD65[i / 2] : 0.5 * (kD65[i / 2] + kD65[i / 2 + 1]);
            response[i] = rec709(matching(wavelength(i)));
            for (size_t c = 0; c < 3; ++c) white.c[c] += response[i].c[c] * d65[i];
        }
        for (Rgb64& r : response)
            for (size_t c = 0; c < 3; ++c) r.c[c] /= white.c[c];
        for (size_t i = 0; i < kSamples; ++i) {
            samples[i].wavelength = wavelength(i);
            for (size_t c = 0; c < 3; ++c) samples[i].weight[c] = response[i].c[c] * d65[i];
        }
    }
    static double wavelength(size_t i) { return kFirst + kStep * static_cast<double>(i); }
};

const Observer& observer() {
    static const Observer o;
    return o;
}

/// Colour under D65 of a factor given as a function of the wavelength.
template <typename Factor>
Rgb64 colour_under_d65(Factor factor) {
    Rgb64 sum;
    for (const ObserverSample& s : observer().samples) {
        const double f = factor(s.wavelength);
        for (size_t c = 0; c < 3; ++c) sum.c[c] += f * s.weight[c];
    }
    return sum;
}

Rgb to_rgb(const Rgb64& v) {
    return {static_cast<float>(v.c[0]), static_cast<float>(v.c[1]), static_cast<float>(v.c[2])};
}

Rgb luminance_one(Rgb64 v) {
    for (double& c : v.c) c = std::max(0.0, c);
    const double y = 0.2126 * v.c[0] + 0.7152 * v.c[1] + 0.0722 * v.c[2];
    if (!(y > 0) || !std::isfinite(y)) return Rgb{0};
    for (double& c : v.c) c /= y;
    return to_rgb(v);
}

/// Reflectance at normal incidence of eta + ik against vacuum.
double normal_reflectance(double eta, double k) {
    return ((eta - 1) * (eta - 1) + k * k) / ((eta + 1) * (eta + 1) + k * k);
}

}  // namespace

std::span<const ObserverSample> observer_samples() {
    return observer().samples;
}

double Spectrum::at(double l) const {
    if (wavelengths.empty()) return 0;
    if (l < wavelengths.front()) return extends ? values.front() : 0;
    if (l > wavelengths.back()) return extends ? values.back() : 0;
    const auto it = std::upper_bound(wavelengths.begin(), wavelengths.end(), l);
    if (it == wavelengths.end()) return values.back();
    const auto i = static_cast<size_t>(it - wavelengths.begin());
    const double a = wavelengths[i - 1], t = (l - a) / (wavelengths[i] - a);
    return (1 - t) * values[i - 1] + t * values[i];
}

Spectrum blackbody_spectrum(double kelvin) {
    // The logarithm of Planck's law, which doesn't underflow at low temperatures.
    const auto log_planck = [kelvin](double nm) {
        constexpr double c2 = 1.438776877e7;  // second radiation constant, nm K
        const double x = c2 / (nm * kelvin);
        return -5 * std::log(nm) - (x > 500 ? x : std::log(std::expm1(x)));
    };
    std::vector<double> logs;
    Spectrum s;
    for (size_t i = 0; i < kSamples; ++i) {
        s.wavelengths.push_back(static_cast<float>(Observer::wavelength(i)));
        logs.push_back(log_planck(Observer::wavelength(i)));
    }
    const double largest = *std::max_element(logs.begin(), logs.end());
    for (const double v : logs) s.values.push_back(static_cast<float>(std::exp(v - largest)));
    return s;
}

Rgb reflectance_colour(const Spectrum& s) {
    return to_rgb(colour_under_d65([&s](double l) { return s.at(l); }));
}

Rgb emission_colour(const Spectrum& s) {
    const Observer& o = observer();
    Rgb64 sum;
    for (size_t i = 0; i < kSamples; ++i)
        for (size_t c = 0; c < 3; ++c)
            sum.c[c] += s.at(Observer::wavelength(i)) * o.response[i].c[c];
    return luminance_one(sum);
}

Rgb chromaticity_colour(double x, double y) {
    return luminance_one(rec709({x / y, 1, (1 - x - y) / y}));
}

Rgb channel_means(const Spectrum& s) {
    const Observer& o = observer();
    Rgb64 sum, weight;
    for (size_t i = 0; i < kSamples; ++i)
        for (size_t c = 0; c < 3; ++c) {
            const double w = std::max(0.0, o.response[i].c[c]) * o.d65[i];
            sum.c[c] += w * s.at(Observer::wavelength(i));
            weight.c[c] += w;
        }
    for (size_t c = 0; c < 3; ++c) sum.c[c] /= weight.c[c];
    return to_rgb(sum);
}

ConductorColours conductor_colours(const Spectrum& eta, const Spectrum& k, Rgb index) {
    const Rgb64 reflectance =
        colour_under_d65([&](double l) { return normal_reflectance(eta.at(l), k.at(l)); });
    ConductorColours r{index, Rgb{0}};
    for (int c = 0; c < 3; ++c) {
        // Saturated metals lie slightly outside of the Rec.709 gamut.
        const double f = std::clamp(reflectance.c[static_cast<size_t>(c)], 0.0, 0.9999);
        const double n = r.eta[c];
        const double k_squared = (f * (n + 1) * (n + 1) - (n - 1) * (n - 1)) / (1 - f);
        if (k_squared >= 0) {
            r.k[c] = static_cast<float>(std::sqrt(k_squared));
        } else {
            r.eta[c] = static_cast<float>((1 + std::sqrt(f)) / (1 - std::sqrt(f)));
        }
    }
    return r;
}

}  // namespace covtrace
