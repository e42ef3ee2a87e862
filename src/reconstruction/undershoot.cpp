#include "reconstruction/undershoot.h"

#include <algorithm>
#include <cmath>

#include "core/vec.h"

namespace covtrace {

namespace {

bool have_negative_samples(const Halves& halves) {
    const auto is_negative = [](const Plane& p) {
        return std::any_of(p.values.begin(), p.values.end(), [](float v) { return v < 0; });
    };
    return std::any_of(halves.begin(), halves.end(), [&](const HalfBuffer& half) {
        return std::any_of(half.color.begin(), half.color.end(), is_negative);
    });
}

}  // namespace

ColorPlanes without_undershoot(ColorPlanes guess, const Halves& halves) {
    if (have_negative_samples(halves)) return guess;
    for (Plane& channel : guess)
        for (float& v : channel.values) v = std::max(0.0f, v);
    return guess;
}

void fill_undershoot(std::span<const Candidate> candidates, const Halves& halves, Selection& s) {
    if (have_negative_samples(halves)) return;
    for (size_t half = 0; half < 2; ++half)
        for (size_t k = 0; k < 3; ++k)
            for (size_t i = 0; i < s.half[half][k].size(); ++i) {
                float& mixture = s.half[half][k][i];
                if (!(mixture < 0)) continue;
                float darkest = kInfinity;
                for (size_t c = 0; c < candidates.size(); ++c)
                    if (const float v = candidates[c][half][k][i]; s.share[c][i] > 0 && v > 0)
                        darkest = std::min(darkest, v);
                mixture = std::isfinite(darkest) ? darkest : 0;
            }
}

}  // namespace covtrace
