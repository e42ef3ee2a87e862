#include "reconstruction/undershoot.h"

#include <algorithm>

namespace covtrace {

void cut_undershoot(std::vector<Candidate>& candidates, const Halves& halves) {
    const auto negative = [](const Plane& p) {
        return std::any_of(p.values.begin(), p.values.end(), [](float v) { return v < 0; });
    };
    for (const HalfBuffer& half : halves)
        if (std::any_of(half.color.begin(), half.color.end(), negative)) return;
    for (Candidate& candidate : candidates)
        for (ColorPlanes& half : candidate)
            for (Plane& channel : half)
                for (float& v : channel.values) v = std::max(0.0f, v);
}

}  // namespace covtrace
