#include "core/display_exposure.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace covtrace {

namespace {

constexpr int kBlock = 8;               // pixels
constexpr double kBrightestPart = 0.1;  // of the blocks with light
/// Brightness of the brightest part from which on an image is taken as it is, and the one that dim
/// images get.
constexpr double kExposed = 0.1, kShown = 0.4;
/// Brightness up to which an image of unknown units is taken as it is: hardly a pixel is below a
/// tenth then, so that more changes nothing but the size of the numbers.
constexpr double kGlaring = 16;
constexpr double kMost = 0x1p20;  // greatest factor of renders, whose units are known

double mean_of_block(const Plane& luminance, int left, int top) {
    double sum = 0;
    int count = 0;
    for (int y = top; y < std::min(top + kBlock, luminance.height); ++y)
        for (int x = left; x < std::min(left + kBlock, luminance.width); ++x)
            if (std::isfinite(luminance(x, y))) {
                sum += double(luminance(x, y));
                ++count;
            }
    return count > 0 ? sum / count : 0;
}

double brightest_pixel(const Plane& luminance) {
    float most = 0;
    for (const float v : luminance.values)
        if (std::isfinite(v)) most = std::max(most, std::abs(v));
    return double(most);
}

/// Brightness that the brightest part exceeds; 0 of images without light.
double brightness(const Plane& luminance) {
    std::vector<double> means;
    for (int y = 0; y < luminance.height; y += kBlock)
        for (int x = 0; x < luminance.width; x += kBlock)
            if (const double mean = mean_of_block(luminance, x, y); mean > 0) means.push_back(mean);
    if (means.empty()) return 0;
    const auto bright = means.begin() + ptrdiff_t(double(means.size() - 1) * (1 - kBrightestPart));
    std::nth_element(means.begin(), bright, means.end());
    return *bright;
}

/// The factor of an image of this brightness, not yet a power of two.
double factor_of(double bright) {
    const double dim = kExposed / bright, glaring = kGlaring / bright;
    if (dim > 1) return std::min(dim * dim, kShown / bright);
    if (glaring < 1) return std::max(glaring * glaring, kShown / bright);
    return 1;
}

double power_of_two_below(double factor) {
    return std::exp2(std::floor(std::log2(factor)));
}

}  // namespace

float display_exposure(const Plane& luminance) {
    const double bright = brightness(luminance);
    if (bright == 0) return 1;
    const double factor =
        std::min({factor_of(bright), kMost, double(kBrightestShown) / brightest_pixel(luminance)});
    return float(power_of_two_below(std::max(1.0, factor)));
}

float exposure_of_unknown_units(const Plane& luminance) {
    const double bright = brightness(luminance);
    if (bright == 0) return 1;
    using Limits = std::numeric_limits<float>;
    return float(power_of_two_below(
        std::clamp(factor_of(bright), double(Limits::min()), double(Limits::max()))));
}

}  // namespace covtrace
