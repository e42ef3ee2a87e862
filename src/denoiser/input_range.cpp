#include "denoiser/input_range.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace covtrace {

namespace {

/// Share of the pixels with light that are no brighter than the one that sets the exposure.
constexpr double kBright = 0.99;
/// Most that the network gets of a pixel, where the one that sets the exposure gets about 1.
constexpr float kMost = 1e4f;

/// The brightest channel that `kBright` of the pixels with light do not exceed; 0 without light.
float bright(const ColorPlanes& light) {
    std::vector<float> values;
    for (size_t i = 0; i < light[0].size(); ++i) {
        float most = 0;
        for (const Plane& channel : light)
            if (std::isfinite(channel[i])) most = std::max(most, channel[i]);
        if (most > 0) values.push_back(most);
    }
    if (values.empty()) return 0;
    const auto at = values.begin() + std::ptrdiff_t(kBright * double(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

}  // namespace

InputRange::InputRange(const ColorPlanes& light) : least_(-kMost), most_(kMost) {
    const float b = bright(light);
    is_dark_ = b == 0;
    if (!is_dark_) exponent_ = -std::ilogb(b);
}

float InputRange::to_network(float value) const {
    if (std::isnan(value)) return 0;
    return std::clamp(std::ldexp(value, exponent_), least_, most_);
}

float InputRange::from_network(float value) const {
    constexpr float kLargest = std::numeric_limits<float>::max();
    return std::clamp(std::ldexp(value, -exponent_), -kLargest, kLargest);
}

}  // namespace covtrace
