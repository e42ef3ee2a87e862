#include "core/display_exposure.h"

#include <algorithm>
#include <cmath>

namespace covtrace {

namespace {

constexpr int kBlock = 8;               // pixels
constexpr double kBrightestPart = 0.1;  // of the blocks with light
/// Brightness of the brightest part from which on an image is taken as it is, and the one that dim
/// images get.
constexpr double kExposed = 0.1, kShown = 0.4;
/// Greatest factor, and what it may make of the brightest pixel: squares of lamps in view stay
/// within single precision, those of their noise too.
constexpr double kMost = 0x1p20, kBrightestPixel = 1e15;

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

}  // namespace

float display_exposure(const Plane& luminance) {
    std::vector<double> means;
    for (int y = 0; y < luminance.height; y += kBlock)
        for (int x = 0; x < luminance.width; x += kBlock)
            if (const double mean = mean_of_block(luminance, x, y); mean > 0) means.push_back(mean);
    if (means.empty()) return 1;
    const auto bright = means.begin() + ptrdiff_t(double(means.size() - 1) * (1 - kBrightestPart));
    std::nth_element(means.begin(), bright, means.end());
    const double factor = std::min({kExposed / *bright * (kExposed / *bright), kShown / *bright,
                                    kMost, kBrightestPixel / brightest_pixel(luminance)});
    return float(std::exp2(std::floor(std::log2(std::max(1.0, factor)))));
}

}  // namespace covtrace
