#include "colour/colour_bands.h"

#include <algorithm>
#include <cmath>

#include "colour/colour_grid.h"
#include "colour/sigmoid_spectrum.h"

namespace covtrace {
namespace {

constexpr size_t kBands = std::tuple_size_v<BandValues>;
constexpr double kFirst = 390, kWidth = 20;  // nanometres

size_t band_of(double wavelength) {
    const double band = std::floor((wavelength - kFirst) / kWidth);
    return static_cast<size_t>(std::clamp(band, 0.0, double(kBands - 1)));
}

/// Mean wavelengths (nanometres) of the bands, by what each adds to colours under white light.
std::array<double, kBands> wavelengths_of_bands() {
    std::array<double, kBands> sums{}, weights{};
    for (const ObserverSample& sample : observer_samples()) {
        double weight = 0;
        for (const double w : sample.weight) weight += std::abs(w);
        sums[band_of(sample.wavelength)] += weight * sample.wavelength;
        weights[band_of(sample.wavelength)] += weight;
    }
    for (size_t b = 0; b < kBands; ++b) sums[b] /= weights[b];
    return sums;
}

}  // namespace

ColourBands::ColourBands(const IlluminantAdaptation& light) {
    for (size_t c = 0; c < 3; ++c) {
        std::array<double, kBands> sums{};
        double white = 0;
        for (const ObserverSample& sample : light.observer()) {
            sums[band_of(sample.wavelength)] += sample.weight[c];
            white += sample.weight[c];
        }
        for (size_t b = 0; b < kBands; ++b) weights_[c][b] = static_cast<float>(sums[b] / white);
    }
}

Rgb ColourBands::unlimited_colour(const BandValues& shares) const {
    Rgb sum;
    for (int c = 0; c < 3; ++c) {
        const BandValues& weights = weights_[static_cast<size_t>(c)];
        for (size_t b = 0; b < kBands; ++b) sum[c] += weights[b] * shares[b];
    }
    return sum;
}

Rgb ColourBands::colour(const BandValues& shares) const {
    return clamp_to_unit(unlimited_colour(shares));
}

BandValues band_values(Rgb reflectance) {
    const Rgb wanted = clamp_to_unit(reflectance);
    BandValues values;
    if (is_grey(wanted)) {
        values.fill(wanted.r);
        return values;
    }
    static const ColourBands white;
    static const std::array<double, kBands> wavelengths = wavelengths_of_bands();
    // The colour in the bands is off that of all wavelengths by up to 0.005. So the spectrum is one
    // of a colour that is as far off on the other side.
    constexpr int kCorrections = 3;
    Rgb aim = wanted;
    for (int i = 0; i <= kCorrections; ++i) {
        const SigmoidSpectrum spectrum = sigmoid_spectrum(aim);
        for (size_t b = 0; b < kBands; ++b)
            values[b] = static_cast<float>(spectrum.at(wavelengths[b]));
        aim = clamp_to_unit(aim + wanted - white.unlimited_colour(values));
    }
    return values;
}

}  // namespace covtrace
