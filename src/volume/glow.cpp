#include "volume/glow.h"

#include <algorithm>

namespace covtrace {

Rgb Glow::at(Vec3 point) const {
    const float scale = factor ? factor->at(point) : 1, largest = field->largest();
    if (!(largest > 0)) return radiance.front() * scale;
    const float place = std::clamp(field->at(point) / largest, 0.0f, 1.0f) *
                        static_cast<float>(radiance.size() - 1);
    const size_t i = std::min(static_cast<size_t>(place), radiance.size() - 2);
    const float t = place - static_cast<float>(i);
    return (radiance[i] * (1 - t) + radiance[i + 1] * t) * scale;
}

}  // namespace covtrace
