#include "colour/sampled_wavelength.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "colour/spectrum.h"

namespace covtrace {

namespace {

/// The choice among the observer's samples, and the distance between these.
struct Choice {
    std::vector<float> ends;  ///< sums of the probabilities up to each sample, of 1 together
    std::vector<SampledWavelength> samples;
    float step = 0;
    Choice() {
        const auto observer = observer_samples();
        const auto size = [](const ObserverSample& s) {
            return std::abs(s.weight[0]) + std::abs(s.weight[1]) + std::abs(s.weight[2]);
        };
        double all = 0, sum = 0;
        for (const ObserverSample& s : observer) all += size(s);
        for (const ObserverSample& s : observer) {
            const double over = all / size(s);
            sum += size(s) / all;
            ends.push_back(static_cast<float>(sum));
            const auto channel = [&](size_t c) { return static_cast<float>(s.weight[c] * over); };
            samples.push_back(
                {static_cast<float>(s.wavelength), {channel(0), channel(1), channel(2)}});
        }
        ends.back() = 1;
        step = samples[1].nanometres - samples[0].nanometres;
    }
};

}  // namespace

SampledWavelength sample_wavelength(float u) {
    static const Choice choice;
    const auto it = std::upper_bound(choice.ends.begin(), choice.ends.end() - 1, u);
    const auto i = static_cast<size_t>(it - choice.ends.begin());
    SampledWavelength w = choice.samples[i];
    // A sample stands for the wavelengths around it, up to its neighbours, the less the farther
    const float first = i > 0 ? choice.ends[i - 1] : 0;
    const float v = 2 * std::clamp((u - first) / (choice.ends[i] - first), 0.0f, 1.0f) - 1;
    const float away = 1 - std::sqrt(1 - std::abs(v));
    const bool up = i == 0 || (v > 0 && i + 1 < choice.samples.size());
    w.nanometres += (up ? away : -away) * choice.step;
    return w;
}

}  // namespace covtrace
