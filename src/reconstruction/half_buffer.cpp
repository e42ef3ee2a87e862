#include "reconstruction/half_buffer.h"

#include <algorithm>

namespace covtrace {

HalfBuffer::HalfBuffer(int w, int h) : count(w, h) {
    for (auto* planes : {&color, &color_variance}) planes->fill(Plane(w, h));
    for (auto* planes : {&feature, &feature_variance}) planes->fill(Plane(w, h));
}

void rescale_variance(Halves& halves) {
    const int w = halves[0].count.width, h = halves[0].count.height;
    // One ratio for the three channels: their noise comes from the same paths.
    Plane sampled(w, h), measured(w, h);
    for (size_t i = 0; i < sampled.size(); ++i)
        for (size_t c = 0; c < 3; ++c) {
            const float d = halves[0].color[c][i] - halves[1].color[c][i];
            sampled[i] += halves[0].color_variance[c][i] + halves[1].color_variance[c][i];
            measured[i] += d * d;
        }
    constexpr int kReach = 6;
    sampled = box_blur(sampled, kReach);
    measured = box_blur(measured, kReach);
    for (HalfBuffer& half : halves)
        for (size_t c = 0; c < 3; ++c) {
            Plane& v = half.color_variance[c];
            for (size_t i = 0; i < v.size(); ++i)
                v[i] *= sampled[i] > 0 ? std::clamp(measured[i] / sampled[i], 0.1f, 1.0f) : 1.0f;
            v = box_blur(v, 1);
        }
}

}  // namespace covtrace
