// A picture with noise of known distribution, as another renderer would have made it.
#pragma once

#include <cmath>
#include <string>

#include "core/rng.h"
#include "image/image.h"

namespace covtrace::test {

inline constexpr int kWidth = 96, kHeight = 64;

inline Image empty_image(int width = kWidth, int height = kHeight) {
    Image image;
    image.data = image.display = {0, 0, width, height};
    return image;
}

/// A zero-filled image with these channels.
inline Image image_with(const std::vector<std::string>& names, int width = 4, int height = 3) {
    Image image = empty_image(width, height);
    for (const std::string& name : names) image.add_channel(name);
    return image;
}

inline float normal_number(Rng& rng) {
    const float u = 1 - rng.next_float(), v = rng.next_float();
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * kPi * v);
}

/// Reflectance of a checkered floor below a plain wall.
inline float albedo(int x, int y) {
    if (y < kHeight / 2) return 0.6f;
    return (x / 6 + y / 6) % 2 == 0 ? 0.8f : 0.2f;
}

/// The picture without noise: the reflectance under light that changes slowly.
inline float truth(int x, int y, float scale = 1) {
    return scale * albedo(x, y) * (1 + 0.6f * std::sin(0.05f * float(x) + 0.03f * float(y)));
}

struct Noise {
    float relative = 0.4f;  ///< deviation over the truth
    uint64_t seed = 1;
    float scale = 1;  ///< of the picture
};

/// A noisy render: R, G, B with the same normal noise, its variance, albedo, N, Z.
inline Image noisy_image(const Noise& noise) {
    Image image = empty_image();
    for (const char* name : {"R", "G", "B", "variance.R", "variance.G", "variance.B", "albedo.R",
                             "albedo.G", "albedo.B", "N.X", "N.Y", "N.Z", "Z"})
        image.add_channel(name);
    Rng rng(noise.seed);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const size_t i = size_t(y) * kWidth + size_t(x);
            const float t = truth(x, y, noise.scale), deviation = noise.relative * t;
            const float value = t + deviation * normal_number(rng);
            for (size_t k = 0; k < 3; ++k) {
                image.channels[k].values[i] = value;
                image.channels[3 + k].values[i] = deviation * deviation;
                image.channels[6 + k].values[i] = albedo(x, y);
            }
            image.channels[y < kHeight / 2 ? 11 : 10].values[i] = 1;
            image.channels[12].values[i] = 5 - 0.02f * float(y);
        }
    return image;
}

/// Root of the mean over pixels and channels of (I - T)^2 / (T^2 + 0.01).
inline double relative_error(const Image& image, float scale = 1) {
    double sum = 0;
    for (const char* name : {"R", "G", "B"}) {
        const Channel& c = *image.find(name);
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                const double t = double(truth(x, y)),
                             d = double(c.values[size_t(y) * kWidth + size_t(x)] / scale) - t;
                sum += d * d / (t * t + 0.01);
            }
    }
    return std::sqrt(sum / (3.0 * kWidth * kHeight));
}

}  // namespace covtrace::test
