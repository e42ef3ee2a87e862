/// Images for denoisers.
#pragma once

#include <cmath>
#include <limits>
#include <random>

#include "reconstruction/denoiser.h"

namespace covtrace {

struct NoisyView {
    ColorPlanes color;
    NoisyFeatures features;
};

/// The image as a denoiser leaves it.
inline ColorPlanes denoised(const Denoiser& denoiser, const NoisyView& view, bool turned = false) {
    return denoiser.denoise(view.features, {{.color = view.color, .turned = turned}})[0];
}

/// A view of light between 0.1 and 2 from left to right, and features, with noise of `seed`.
inline NoisyView noisy_view(int width, int height, unsigned seed = 1) {
    std::mt19937 random(seed);
    const auto uniform = [&random] { return float(random() % 65536) / 65536; };
    const Plane black(width, height);
    NoisyView view{{black, black, black}, {{black, black, black}, {black, black, black}}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float light = (0.1f + 1.9f * float(x) / float(width)) * -std::log1p(-uniform());
            for (size_t c = 0; c < 3; ++c) {
                view.color[c](x, y) = light;
                view.features.albedo[c](x, y) = 0.4f + 0.2f * uniform();
                view.features.normal[c](x, y) = c == 2 ? 1 : 0.2f * uniform() - 0.1f;
            }
        }
    return view;
}

inline void set_pixel(ColorPlanes& color, int x, int y, float value) {
    for (Plane& channel : color) channel(x, y) = value;
}

inline bool is_finite(const ColorPlanes& color) {
    for (const Plane& channel : color)
        for (float v : channel.values)
            if (!std::isfinite(v)) return false;
    return true;
}

inline float largest(const ColorPlanes& color) {
    float most = 0;
    for (const Plane& channel : color)
        for (float v : channel.values) most = std::max(most, v);
    return most;
}

}  // namespace covtrace
