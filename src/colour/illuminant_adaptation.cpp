#include "colour/illuminant_adaptation.h"

#include <algorithm>

#include "colour/colour_grid.h"
#include "colour/sigmoid_spectrum.h"
#include "core/parallel.h"

namespace covtrace {

namespace {

constexpr float kFaintestChannel = 0.05f;
/// Least difference between an illuminant's channels, relative to the largest, with which it is not
/// white.
constexpr float kSmallestTint = 1e-3f;

}  // namespace

IlluminantAdaptation::IlluminantAdaptation(Rgb illuminant) {
    const float largest = max_component(illuminant);
    if (!(largest > 0) || !is_finite(illuminant)) return;
    Rgb tint = illuminant / largest;
    if (std::min({tint.r, tint.g, tint.b}) > 1 - kSmallestTint) return;
    for (int c = 0; c < 3; ++c) tint[c] = std::max(tint[c], kFaintestChannel);

    // The light's spectrum is the sigmoid of half its colour, as pbrt-v4 has it for lights.
    const SigmoidSpectrum light = sigmoid_spectrum(0.5f * tint);
    std::array<double, 3> colour{};
    for (const ObserverSample& s : observer_samples())
        for (size_t c = 0; c < 3; ++c) colour[c] += light.at(s.wavelength) * s.weight[c];
    for (const ObserverSample& s : observer_samples()) {
        ObserverSample& lit = observer_.emplace_back(s);
        for (size_t c = 0; c < 3; ++c) lit.weight[c] *= light.at(s.wavelength) / colour[c];
    }
}

Rgb IlluminantAdaptation::change(Rgb reflectance) const {
    if (is_identity() || is_grey(reflectance)) return {};
    const SigmoidSpectrum spectrum = sigmoid_spectrum(reflectance);
    std::array<double, 3> sum{};
    for (size_t i = 0; i < observer_.size(); ++i) {
        const ObserverSample &lit = observer_[i], &white = observer_samples()[i];
        const double s = spectrum.at(white.wavelength);
        for (size_t c = 0; c < 3; ++c) sum[c] += s * (lit.weight[c] - white.weight[c]);
    }
    return {static_cast<float>(sum[0]), static_cast<float>(sum[1]), static_cast<float>(sum[2])};
}

Rgb IlluminantAdaptation::operator()(Rgb reflectance) const {
    const Rgb before = clamp_to_unit(reflectance);
    return clamp_to_unit(before + change(before));
}

AdaptationTable::AdaptationTable(const IlluminantAdaptation& adaptation) {
    if (adaptation.is_identity()) return;
    changes_.resize(kColourGridSize);
    parallel_for(kColourNodes * kColourNodes, [&](int64_t row) {
        for (size_t b = 0; b < kColourNodes; ++b) {
            const size_t node = static_cast<size_t>(row) * kColourNodes + b;
            changes_[node] = adaptation.change(colour_of_node(node));
        }
    });
}

Rgb AdaptationTable::operator()(Rgb reflectance) const {
    const Rgb before = clamp_to_unit(reflectance);
    if (changes_.empty() || is_grey(before)) return before;
    const ColourCell cell = colour_cell(before);
    Rgb change;
    for (size_t i = 0; i < cell.nodes.size(); ++i)
        change += cell.weights[i] * changes_[cell.nodes[i]];
    return clamp_to_unit(before + change);
}

}  // namespace covtrace
