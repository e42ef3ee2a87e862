#include "colour/sigmoid_spectrum.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace covtrace {

namespace {

using Triple = std::array<double, 3>;
using Matrix = std::array<Triple, 3>;

/// Value of the darkest constant spectrum, and 1 less that of the brightest: sigmoids reach neither
/// 0 nor 1.
constexpr double kDarkest = 1e-4;

double position(double wavelength) {
    constexpr double kMiddle = 580, kHalfWidth = 200;  // the observer's range
    return (wavelength - kMiddle) / kHalfWidth;
}

double polynomial(const Triple& c, double t) {
    return (c[2] * t + c[1]) * t + c[0];
}

/// Difference of the spectrum's colour to the target, and its derivative by the coefficients.
struct Misfit {
    Triple value{};
    Matrix derivative{};  // [channel][coefficient]
    double squared() const {
        return value[0] * value[0] + value[1] * value[1] + value[2] * value[2];
    }
    double largest() const {
        return std::max({std::abs(value[0]), std::abs(value[1]), std::abs(value[2])});
    }
};

using Four = double __attribute__((vector_size(32)));

void take_square_roots(Four& v) {
    for (int k = 0; k < 4; ++k) v[k] = std::sqrt(v[k]);
}

/// The observer's samples, four side by side; those beyond the last have no weight.
struct FourSamples {
    Four position{};
    std::array<Four, 3> weight{};
};
const std::vector<FourSamples>& four_samples() {
    static const std::vector<FourSamples> all = [] {
        const auto samples = observer_samples();
        std::vector<FourSamples> list((samples.size() + 3) / 4);
        for (size_t i = 0; i < samples.size(); ++i) {
            FourSamples& four = list[i / 4];
            four.position[i % 4] = position(samples[i].wavelength);
            for (size_t c = 0; c < 3; ++c) four.weight[c][i % 4] = samples[i].weight[c];
        }
        return list;
    }();
    return all;
}

Misfit misfit(const Triple& c, const Triple& target) {
    std::array<std::array<Four, 4>, 3> sum{};  // for each channel: the value, then its derivatives
    for (const FourSamples& samples : four_samples()) {
        const Four t = samples.position, p = (c[2] * t + c[1]) * t + c[0];
        Four root = 1 + p * p;
        take_square_roots(root);
        const Four q = 1 / root, s = 0.5 + 0.5 * p * q, slope = 0.5 * q * q * q;
        for (size_t i = 0; i < 3; ++i) {
            const Four w = samples.weight[i] * slope, wt = w * t;
            sum[i][0] += samples.weight[i] * s;
            sum[i][1] += w;
            sum[i][2] += wt;
            sum[i][3] += wt * t;
        }
    }
    const auto total = [](const Four& v) { return (v[0] + v[2]) + (v[1] + v[3]); };
    Misfit m;
    for (size_t i = 0; i < 3; ++i) {
        m.value[i] = total(sum[i][0]) - target[i];
        for (size_t k = 0; k < 3; ++k) m.derivative[i][k] = total(sum[i][k + 1]);
    }
    return m;
}

double determinant(const Triple& a, const Triple& b, const Triple& c) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/// A Levenberg-Marquardt step: (J^T J + damping diag(J^T J)) step = -J^T misfit, solved by Cramer's
/// rule.
Triple damped_step(const Misfit& m, double damping) {
    Matrix a{};
    Triple b{};
    for (size_t i = 0; i < 3; ++i)
        for (size_t j = 0; j < 3; ++j) {
            b[j] -= m.derivative[i][j] * m.value[i];
            for (size_t k = 0; k < 3; ++k) a[j][k] += m.derivative[i][j] * m.derivative[i][k];
        }
    for (size_t j = 0; j < 3; ++j) a[j][j] *= 1 + damping;
    const double d = determinant(a[0], a[1], a[2]);
    if (!(d > 0)) return {};
    // The matrix is symmetric, so its rows are its columns.
    return {determinant(b, a[1], a[2]) / d, determinant(a[0], b, a[2]) / d,
            determinant(a[0], a[1], b) / d};
}

}  // namespace

double SigmoidSpectrum::at(double wavelength) const {
    const double p = polynomial(coefficients, position(wavelength));
    return 0.5 + 0.5 * p / std::sqrt(1 + p * p);
}

SigmoidSpectrum sigmoid_spectrum(Rgb colour) {
    Triple target{};
    for (int c = 0; c < 3; ++c)
        target[static_cast<size_t>(c)] =  // what is not a number becomes the darkest
            std::min(std::max(kDarkest, double(colour[c])), 1 - kDarkest);
    const double mean = (target[0] + target[1] + target[2]) / 3;
    Triple c{(mean - 0.5) / std::sqrt(mean * (1 - mean)), 0, 0};
    if (target[0] == target[1] && target[1] == target[2]) return {c};

    constexpr int kMostSteps = 60;
    constexpr double kLargestCoefficient = 1000;
    const double tolerance = 1e-6 * std::max({target[0], target[1], target[2]});
    Misfit best = misfit(c, target);
    double damping = 1e-3;
    for (int step = 0; step < kMostSteps && best.largest() > tolerance; ++step) {
        Triple next = damped_step(best, damping);
        for (size_t i = 0; i < 3; ++i)
            next[i] = std::clamp(c[i] + next[i], -kLargestCoefficient, kLargestCoefficient);
        const Misfit there = misfit(next, target);
        if (there.squared() < best.squared()) {
            best = there;
            c = next;
            damping *= 0.2;
        } else {
            damping *= 6;
        }
    }
    return {c};
}

Spectrum unbounded_spectrum(Rgb colour) {
    const float scale = 2 * max_component(colour);
    const SigmoidSpectrum sigmoid = sigmoid_spectrum(scale > 0 ? colour / scale : Rgb{});
    Spectrum s;
    s.extends = true;
    for (const ObserverSample& sample : observer_samples()) {
        s.wavelengths.push_back(static_cast<float>(sample.wavelength));
        s.values.push_back(static_cast<float>(scale * sigmoid.at(sample.wavelength)));
    }
    return s;
}

}  // namespace covtrace
