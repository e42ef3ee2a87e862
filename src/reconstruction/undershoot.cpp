#include "reconstruction/undershoot.h"

#include <algorithm>
#include <cmath>

#include "core/vec.h"
#include "reconstruction/regression.h"

namespace covtrace {

namespace {

/// 1 for the pixels that a fit could reach from a pixel whose samples are negative, else 0.
Plane beside_negative(const Halves& halves) {
    Plane beside(halves[0].count.width, halves[0].count.height);
    for (const HalfBuffer& half : halves)
        for (const Plane& channel : half.color)
            for (size_t i = 0; i < beside.size(); ++i)
                if (channel[i] < 0) beside[i] = 1;
    // A share of one pixel in the window, less rounding
    constexpr float kOnePixel = 0.5f / sqr(2 * kRegressionReach + 1.0f);
    beside = box_blur(beside, kRegressionReach);
    for (float& v : beside.values) v = v > kOnePixel ? 1.0f : 0.0f;
    return beside;
}

}  // namespace

ColorPlanes without_undershoot(ColorPlanes guess, const Halves& halves) {
    const Plane keep = beside_negative(halves);
    for (Plane& channel : guess)
        for (size_t i = 0; i < keep.size(); ++i)
            if (keep[i] == 0) channel[i] = std::max(0.0f, channel[i]);
    return guess;
}

void fill_undershoot(std::span<const Candidate> candidates, const Halves& halves, Selection& s) {
    const Plane keep = beside_negative(halves);
    for (size_t half = 0; half < 2; ++half)
        for (size_t k = 0; k < 3; ++k)
            for (size_t i = 0; i < s.half[half][k].size(); ++i) {
                float& mixture = s.half[half][k][i];
                if (keep[i] > 0 || !(mixture < 0)) continue;
                float darkest = kInfinity;
                for (const Candidate& candidate : candidates)
                    if (const float v = candidate[half][k][i]; v > 0)
                        darkest = std::min(darkest, v);
                mixture = std::isfinite(darkest) ? darkest : 0;
            }
}

}  // namespace covtrace
