// Synthetic halves: a known image with Gaussian noise, constant features.
#pragma once

#include <cmath>
#include <functional>

#include "core/rng.h"
#include "reconstruction/half_buffer.h"

namespace covtrace::test {

inline float normal_number(Rng& rng) {
    const float u = 1 - rng.next_float(), v = rng.next_float();
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * kPi * v);
}

/// Halves with truth(x, y) in all channels, and noise of deviation `sigma` in each half.
inline Halves noisy_halves(int w, int h, const std::function<float(int, int)>& truth, float sigma,
                           uint64_t seed) {
    Halves halves{HalfBuffer(w, h), HalfBuffer(w, h)};
    Rng rng(seed);
    for (HalfBuffer& half : halves)
        for (int y = 0; y < h; ++y)
            for (int x = 0; x < w; ++x) {
                half.count(x, y) = 8;
                for (size_t c = 0; c < 3; ++c) {
                    half.color[c](x, y) = truth(x, y) + sigma * normal_number(rng);
                    half.color_variance[c](x, y) = sigma * sigma;
                }
            }
    return halves;
}

inline double mean_of(const ColorPlanes& color) {
    double sum = 0;
    for (const Plane& p : color)
        for (float v : p.values) sum += double(v);
    return sum / double(3 * color[0].size());
}

inline double mean_squared_error(const ColorPlanes& color,
                                 const std::function<float(int, int)>& truth) {
    double sum = 0;
    for (const Plane& p : color)
        for (int y = 0; y < p.height; ++y)
            for (int x = 0; x < p.width; ++x) {
                const double d = double(p(x, y)) - double(truth(x, y));
                sum += d * d;
            }
    return sum / double(3 * color[0].size());
}

}  // namespace covtrace::test
