/// One number per pixel, row by row, and the blurs that work on it.
#pragma once

#include <cstddef>
#include <vector>

namespace covtrace {

struct Plane {
    Plane() = default;
    Plane(int w, int h, float value = 0)
        : width(w), height(h), values(size_t(w) * size_t(h), value) {}
    int width = 0, height = 0;
    std::vector<float> values;

    float operator()(int x, int y) const { return values[size_t(y) * size_t(width) + size_t(x)]; }
    float& operator()(int x, int y) { return values[size_t(y) * size_t(width) + size_t(x)]; }
    float operator[](size_t i) const { return values[i]; }
    float& operator[](size_t i) { return values[i]; }
    size_t size() const { return values.size(); }
};

/// Mean over (2 radius + 1)^2 pixels; beyond its border the image repeats its outermost pixels.
Plane box_blur(const Plane& plane, int radius);

/// Gaussian mean with deviation `sigma` pixels, cut at 3 sigma; over the image's own pixels only.
Plane gaussian_blur(const Plane& plane, float sigma);

/// Gaussian sum with deviation `sigma` pixels, cut at 3 sigma: the image is black beyond its
/// border, and the kernel stays symmetric there.
Plane gaussian_sum(const Plane& plane, float sigma);

}  // namespace covtrace
