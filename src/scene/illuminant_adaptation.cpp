#include "scene/illuminant_adaptation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/fast_math.h"
#include "core/parallel.h"
#include "scene/sigmoid_spectrum.h"

namespace covtrace {

namespace {

constexpr float kFaintestChannel = 0.05f;
/// Illuminants whose channels differ by less are white.
constexpr float kSmallestTint = 1e-3f;

/// Nodes of the table per axis. They crowd towards black and white, where the change depends on the
/// ratios of the channels, or of what the channels lack to 1, alone.
constexpr int kNodes = 25;
constexpr int kCells = kNodes - 1;

float node(int64_t i) {
    return sqr(std::sin(0.5f * kPi * static_cast<float>(i) / kCells));
}
/// Inverse of node().
float node_position(float value) {
    return arctangent(std::sqrt(value), std::sqrt(1 - value)) * (2 * kInvPi * kCells);
}

/// What is not a number becomes 0.
Rgb clamp_to_unit(Rgb c) {
    return {std::min(std::max(0.0f, c.r), 1.0f), std::min(std::max(0.0f, c.g), 1.0f),
            std::min(std::max(0.0f, c.b), 1.0f)};
}

bool is_grey(Rgb c) {
    return c.r == c.g && c.g == c.b;
}

}  // namespace

IlluminantAdaptation::IlluminantAdaptation(Rgb illuminant) {
    const float largest = max_component(illuminant);
    if (!(largest > 0) || !is_finite(illuminant)) return;
    Rgb tint = illuminant / largest;
    if (std::min({tint.r, tint.g, tint.b}) > 1 - kSmallestTint) return;
    for (int c = 0; c < 3; ++c) tint[c] = std::max(tint[c], kFaintestChannel);

    // pbrt-v4 gives lights the sigmoid of half their colour as well.
    const SigmoidSpectrum light = sigmoid_spectrum(0.5f * tint);
    std::array<double, 3> colour{};
    for (const ObserverSample& s : observer_samples())
        for (size_t c = 0; c < 3; ++c) colour[c] += light.at(s.wavelength) * s.weight[c];
    for (const ObserverSample& s : observer_samples()) {
        Weight& w = weights_.emplace_back();
        w.wavelength = s.wavelength;
        for (size_t c = 0; c < 3; ++c)
            w.change[c] = s.weight[c] * (light.at(s.wavelength) / colour[c] - 1);
    }
}

Rgb IlluminantAdaptation::change(Rgb reflectance) const {
    if (is_identity() || is_grey(reflectance)) return {};
    const SigmoidSpectrum spectrum = sigmoid_spectrum(reflectance);
    std::array<double, 3> sum{};
    for (const Weight& w : weights_) {
        const double s = spectrum.at(w.wavelength);
        for (size_t c = 0; c < 3; ++c) sum[c] += s * w.change[c];
    }
    return {static_cast<float>(sum[0]), static_cast<float>(sum[1]), static_cast<float>(sum[2])};
}

Rgb IlluminantAdaptation::operator()(Rgb reflectance) const {
    const Rgb before = clamp_to_unit(reflectance);
    return clamp_to_unit(before + change(before));
}

AdaptationTable::AdaptationTable(const IlluminantAdaptation& adaptation) {
    if (adaptation.is_identity()) return;
    constexpr auto kCount = static_cast<size_t>(kNodes);
    changes_.resize(kCount * kCount * kCount);
    parallel_for(kNodes * kNodes, [&](int64_t row) {
        for (int b = 0; b < kNodes; ++b)
            changes_[static_cast<size_t>(row * kNodes + b)] =
                adaptation.change({node(row / kNodes), node(row % kNodes), node(b)});
    });
}

const Rgb& AdaptationTable::at(int r, int g, int b) const {
    return changes_[static_cast<size_t>((r * kNodes + g) * kNodes + b)];
}

Rgb AdaptationTable::operator()(Rgb reflectance) const {
    const Rgb before = clamp_to_unit(reflectance);
    if (changes_.empty() || is_grey(before)) return before;
    std::array<int, 3> corner{};
    std::array<float, 3> rest{};
    for (int c = 0; c < 3; ++c) {
        const auto i = static_cast<size_t>(c);
        const float x = node_position(before[c]);
        corner[i] = std::min(static_cast<int>(x), kCells - 1);
        rest[i] = x - static_cast<float>(corner[i]);
    }
    // From the cell's first corner to its last, one channel after the other: linear in each of six
    // tetrahedra that share the cell's diagonal, so that what is nearly grey hardly changes.
    std::array<size_t, 3> order{0, 1, 2};
    if (rest[order[0]] < rest[order[1]]) std::swap(order[0], order[1]);
    if (rest[order[1]] < rest[order[2]]) std::swap(order[1], order[2]);
    if (rest[order[0]] < rest[order[1]]) std::swap(order[0], order[1]);
    float left = 1;
    Rgb change;
    for (const size_t axis : order) {
        change += (left - rest[axis]) * at(corner[0], corner[1], corner[2]);
        left = rest[axis];
        ++corner[axis];
    }
    change += left * at(corner[0], corner[1], corner[2]);
    return clamp_to_unit(before + change);
}

}  // namespace covtrace
