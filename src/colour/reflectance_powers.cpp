#include "colour/reflectance_powers.h"

#include <algorithm>
#include <cmath>

#include "colour/colour_grid.h"
#include "colour/sigmoid_spectrum.h"
#include "core/parallel.h"

namespace covtrace {
namespace {

constexpr size_t kPowers = std::tuple_size_v<ReflectancePowers>;

ReflectancePowers per_channel(Rgb reflectance) {
    ReflectancePowers powers;
    powers[0] = reflectance;
    for (size_t j = 1; j < kPowers; ++j) powers[j] = powers[j - 1] * reflectance;
    return powers;
}

}  // namespace

ReflectancePowers reflectance_powers(Rgb reflectance, const IlluminantAdaptation& light) {
    const Rgb c = clamp_to_unit(reflectance);
    if (is_grey(c)) return per_channel(c);
    const SigmoidSpectrum spectrum = sigmoid_spectrum(c);
    std::array<std::array<double, 3>, kPowers> sums{};
    for (const ObserverSample& sample : light.observer()) {
        const double s = spectrum.at(sample.wavelength);
        double power = s;
        for (size_t j = 1; j < kPowers; ++j) {
            power *= s;
            for (size_t i = 0; i < 3; ++i) sums[j][i] += power * sample.weight[i];
        }
    }
    ReflectancePowers powers;
    powers[0] = light(c);
    for (size_t j = 1; j < kPowers; ++j)
        powers[j] = {static_cast<float>(sums[j][0]), static_cast<float>(sums[j][1]),
                     static_cast<float>(sums[j][2])};
    return powers;
}

Rgb sum_of_bounces(const ReflectancePowers& powers, float again, int bounces) {
    Rgb sum;
    float factor = 1;
    const auto known = static_cast<size_t>(std::clamp(bounces, 0, static_cast<int>(kPowers)));
    for (size_t j = 0; j < known; ++j) {
        // Powers are cut to 1, so that no channel gains light where a power lies outside Rec.709.
        for (int c = 0; c < 3; ++c) sum[c] += factor * std::min(powers[j][c], 1.0f);
        factor *= again;
    }
    const Rgb &last = powers[kPowers - 1], &before = powers[kPowers - 2];
    const auto left = static_cast<float>(bounces - static_cast<int>(known));
    for (int c = 0; c < 3; ++c) {
        if (left > 0 && last[c] > 0) {
            const float ratio = last[c] < before[c] ? last[c] / before[c] : 1;
            const float next = again * ratio;  // over the term before
            const float terms = next < 1 ? (1 - std::pow(next, left)) / (1 - next) : left;
            sum[c] += factor * std::min(last[c], 1.0f) * ratio * terms;
        }
        sum[c] = std::max(sum[c], 0.0f);
    }
    return sum;
}

ReflectancePowersTable::ReflectancePowersTable(const IlluminantAdaptation& light)
    : changes_(kColourGridSize) {
    parallel_for(kColourNodes * kColourNodes, [&](int64_t row) {
        for (size_t b = 0; b < kColourNodes; ++b) {
            const size_t node = static_cast<size_t>(row) * kColourNodes + b;
            const Rgb c = colour_of_node(node);
            const ReflectancePowers is = reflectance_powers(c, light), plain = per_channel(c);
            for (size_t j = 0; j < kPowers; ++j) changes_[node][j] = is[j] - plain[j];
        }
    });
}

ReflectancePowers ReflectancePowersTable::operator()(Rgb reflectance) const {
    const Rgb c = clamp_to_unit(reflectance);
    ReflectancePowers powers = per_channel(c);
    if (changes_.empty() || is_grey(c)) return powers;
    const ColourCell cell = colour_cell(c);
    for (size_t i = 0; i < cell.nodes.size(); ++i)
        for (size_t j = 0; j < kPowers; ++j)
            powers[j] += cell.weights[i] * changes_[cell.nodes[i]][j];
    powers[0] = clamp_to_unit(powers[0]);
    return powers;
}

}  // namespace covtrace
