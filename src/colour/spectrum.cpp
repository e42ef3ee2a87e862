#include "colour/spectrum.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "colour/standard_observer.h"

namespace covtrace {

namespace {

struct Rgb64 {
    std::array<double, 3> c{};
};

constexpr int kFirst = 380, kLast = 780;
constexpr size_t kSamples = (kLast - kFirst) / kObserverStep + 1;

// CIE standard illuminant D65, relative power every 10 nm from 380 to 780 (CIE 15:2004, table T.1).
constexpr std::array<double, 41> kD65{49.9755, 54.6482, 82.7549, 91.486,  93.4318, 86.6823, 104.865,
                                      117.008, 117.812, 114.861, 115.923, 108.811, 109.354, 107.802,
                                      104.79,  107.689, 104.405, 104.046, 100.0,   96.3342, 95.788,
                                      88.6856, 90.0062, 89.5991, 87.6987, 83.2886, 83.6992, 80.0268,
                                      80.2146, 82.2778, 78.2842, 69.7213, 71.6091, 74.349,  61.604,
                                      69.8856, 75.087,  63.5927, 46.4182, 66.8054, 63.3828};

/// Converts XYZ to linear Rec.709, from the primaries and the white point of ITU-R BT.709.
Rgb64 rec709(const TristimulusValues& v) {
    return {{3.2409699419 * v.x - 1.5373831776 * v.y - 0.4986107603 * v.z,
             -0.9692436363 * v.x + 1.8759675015 * v.y + 0.0415550574 * v.z,
             0.0556300797 * v.x - 0.2039769589 * v.y + 1.0569715142 * v.z}};
}

double d65_at(double l) {
    const double x = (l - kFirst) / 10;
    const auto i = std::min(static_cast<size_t>(x), kD65.size() - 2);
    const double t = x - static_cast<double>(i);
    return (1 - t) * kD65[i] + t * kD65[i + 1];
}

/// Response of the observer: the colour that light of each wavelength adds, in a table by
/// nanometres, linear between them.
class Response {
  public:
    Response() {
        for (size_t i = 0; i < table_.size(); ++i)
            table_[i] = rec709(matching_functions(kFirst + static_cast<double>(i)));
    }
    Rgb64 at(double l) const {
        const auto i = std::min(static_cast<size_t>(l - kFirst), table_.size() - 2);
        const double t = l - kFirst - static_cast<double>(i);
        Rgb64 r;
        for (size_t c = 0; c < 3; ++c) r.c[c] = (1 - t) * table_[i].c[c] + t * table_[i + 1].c[c];
        return r;
    }

  private:
    std::array<Rgb64, kLast - kFirst + 1> table_{};
};

const Response& response() {
    static const Response r;
    return r;
}

/// Borders of the pieces on which spectra, D65 and the response are straight lines.
std::vector<double> pieces(std::initializer_list<const Spectrum*> spectra) {
    std::vector<double> at;
    for (int l = kFirst; l <= kLast; ++l) at.push_back(l);
    for (const Spectrum* s : spectra)
        for (const float l : s->wavelengths)
            if (l > kFirst && l < kLast) at.push_back(double(l));
    std::sort(at.begin(), at.end());
    return at;
}

/// Integral of `weight`, a colour that depends on the wavelength, times `factor`, a number that
/// does. Gauss' rule of two points is exact for three straight lines multiplied, and never looks at
/// a border, where spectra that do not extend jump to zero.
template <typename Weight, typename Factor>
Rgb64 integral(const std::vector<double>& pieces, Weight weight, Factor factor) {
    constexpr double kNode = 0.5773502691896257;  // 1 / sqrt(3)
    Rgb64 sum;
    for (size_t i = 1; i < pieces.size(); ++i) {
        const double half = (pieces[i] - pieces[i - 1]) / 2;
        if (!(half > 0)) continue;
        for (const double node : {-kNode, kNode}) {
            const double l = pieces[i - 1] + half * (1 + node), f = half * factor(l);
            if (f == 0) continue;
            const Rgb64 w = weight(l);
            for (size_t c = 0; c < 3; ++c) sum.c[c] += f * w.c[c];
        }
    }
    return sum;
}

Rgb64 under_d65(double l) {
    Rgb64 r = response().at(l);
    for (double& c : r.c) c *= d65_at(l);
    return r;
}

double one(double) {
    return 1;
}

const Rgb64& white() {
    static const Rgb64 w = integral(pieces({}), under_d65, one);
    return w;
}

Rgb64 quotient(Rgb64 a, const Rgb64& b) {
    for (size_t c = 0; c < 3; ++c) a.c[c] /= b.c[c];
    return a;
}

/// The observer in few samples, for smooth functions that are added up often. Each sample has the
/// weight of the straight lines on both sides of it, so that sums are the integrals of the lines
/// between the samples.
struct Observer {
    std::array<ObserverSample, kSamples> samples{};
    Observer() {
        for (size_t i = 0; i < kSamples; ++i) {
            const double middle = kFirst + kObserverStep * static_cast<double>(i);
            std::vector<double> at;
            for (int l = -kObserverStep; l <= kObserverStep; ++l)
                if (middle + l >= kFirst && middle + l <= kLast) at.push_back(middle + l);
            const auto share = [middle](double l) {
                return 1 - std::abs(l - middle) / kObserverStep;
            };
            samples[i] = {middle, quotient(integral(at, under_d65, share), white()).c};
        }
    }
};

/// Colour under D65 of a factor given as a function of the wavelength.
template <typename Factor>
Rgb64 colour_under_d65(const std::vector<double>& pieces, Factor factor) {
    return quotient(integral(pieces, under_d65, factor), white());
}

Rgb to_rgb(const Rgb64& v) {
    return {static_cast<float>(v.c[0]), static_cast<float>(v.c[1]), static_cast<float>(v.c[2])};
}

double luminance_of(const Rgb64& v) {
    return 0.2126 * v.c[0] + 0.7152 * v.c[1] + 0.0722 * v.c[2];
}

Rgb luminance_one(Rgb64 v) {
    const double y = luminance_of(v);
    if (!(y > 0) || !std::isfinite(y)) return Rgb{0};
    // Negative components, of colours outside Rec.709, are cut off last, as a viewer of pbrt's
    // images does.
    for (double& c : v.c) c = std::max(0.0, c / y);
    return to_rgb(v);
}

/// The logarithm of Planck's law but for a factor; it doesn't underflow at low temperatures.
double log_planck(double nm, double kelvin) {
    constexpr double c2 = 1.438776877e7;  // second radiation constant, nm K
    const double x = c2 / (nm * kelvin);
    return -5 * std::log(nm) - (x > 500 ? x : std::log(std::expm1(x)));
}

/// Reflectance at normal incidence of eta + ik against vacuum.
double normal_reflectance(double eta, double k) {
    return ((eta - 1) * (eta - 1) + k * k) / ((eta + 1) * (eta + 1) + k * k);
}

}  // namespace

std::span<const ObserverSample> observer_samples() {
    static const Observer o;
    return o.samples;
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
    constexpr int kShortest = 360, kLongest = 830;
    std::vector<double> logs;
    Spectrum s;
    for (int l = kShortest; l <= kLongest; ++l) {
        s.wavelengths.push_back(static_cast<float>(l));
        logs.push_back(log_planck(l, kelvin));
    }
    const double largest = *std::max_element(logs.begin(), logs.end());
    for (const double v : logs) s.values.push_back(static_cast<float>(std::exp(v - largest)));
    return s;
}

float blackbody_luminance(double kelvin) {
    constexpr double kWien = 2.897771955e6;  // nm K
    const double largest = log_planck(kWien / kelvin, kelvin);
    const auto light = [](double l) { return response().at(l); };
    const auto relative = [&](double l) { return std::exp(log_planck(l, kelvin) - largest); };
    const double y = kLuminanceOfOne * luminance_of(integral(pieces({}), light, relative)) /
                     luminance_of(integral(pieces({}), light, one));
    return static_cast<float>(y);
}

Rgb reflectance_colour(const Spectrum& s) {
    return to_rgb(colour_under_d65(pieces({&s}), [&s](double l) { return s.at(l); }));
}

Rgb emission_colour(const Spectrum& s) {
    const auto light = [](double l) { return response().at(l); };
    // A single wavelength is treated as a line, because its integral over all others is nothing.
    const bool is_line = s.wavelengths.size() == 1 && !s.extends;
    if (is_line) {
        const float l = s.wavelengths[0];
        if (!(s.values[0] > 0) || l < kFirst || l > kLast) return Rgb{0};
        return luminance_one(quotient(light(l), white()));
    }
    return luminance_one(
        quotient(integral(pieces({&s}), light, [&s](double l) { return s.at(l); }), white()));
}

Rgb chromaticity_colour(double x, double y) {
    return luminance_one(rec709({x / y, 1, (1 - x - y) / y}));
}

Rgb channel_means(const Spectrum& s) {
    const auto seen = [](double l) {
        Rgb64 w = under_d65(l);
        for (double& c : w.c) c = std::max(0.0, c);
        return w;
    };
    const std::vector<double> at = pieces({&s});
    return to_rgb(
        quotient(integral(at, seen, [&s](double l) { return s.at(l); }), integral(at, seen, one)));
}

ConductorColours conductor_colours(const Spectrum& eta, const Spectrum& k, Rgb index) {
    const Rgb64 reflectance = colour_under_d65(
        pieces({&eta, &k}), [&](double l) { return normal_reflectance(eta.at(l), k.at(l)); });
    ConductorColours r{index, Rgb{0}};
    for (int c = 0; c < 3; ++c) {
        // The reflectance is cut to [0, 1), as saturated metals lie slightly outside of the Rec.709
        // gamut.
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
