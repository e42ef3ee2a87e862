#include "image/flip.h"

#include <array>
#include <cassert>
#include <cmath>

#include "core/parallel.h"

namespace covtrace {

namespace {

// Exponents, thresholds and widths of FLIP; the comments give the symbols of Andersson et al. 2020
// (see flip.h).
constexpr float kColorExponent = 0.7f;          // q_c
constexpr float kColorKnee = 0.4f;              // p_c, as a part of the largest difference
constexpr float kColorKneeValue = 0.95f;        // p_t
constexpr float kFeatureWidthDegrees = 0.082f;  // w
constexpr float kFeatureExponent = 0.5f;        // q_f

using Color = std::array<float, 3>;
using Plane = std::vector<float>;

/// Converts linear sRGB to CIE XYZ over the white point, so that white is (1, 1, 1).
Color to_relative_xyz(Rgb c) {
    // The matrix has the primaries and D65 white of sRGB as exact fractions of the chromaticities
    // (IEC 61966-2-1).
    constexpr double kX[3] = {10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794};
    constexpr double kY[3] = {2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897};
    constexpr double kZ[3] = {1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382};
    const auto relative = [&](const double(&row)[3]) {
        const double white = row[0] + row[1] + row[2];
        return float(row[0] / white) * c.r + float(row[1] / white) * c.g +
               float(row[2] / white) * c.b;
    };
    return {relative(kX), relative(kY), relative(kZ)};
}

/// The inverse of to_relative_xyz, by Cramer's rule on its own matrix.
Rgb from_relative_xyz(const Color& xyz) {
    static const std::array<Color, 3> kInverse = [] {
        const Color r = to_relative_xyz({1, 0, 0}), g = to_relative_xyz({0, 1, 0}),
                    b = to_relative_xyz({0, 0, 1});
        const auto cofactors = [](const Color& p, const Color& q) {
            return std::array<double, 3>{double(p[1]) * q[2] - double(p[2]) * q[1],
                                         double(p[2]) * q[0] - double(p[0]) * q[2],
                                         double(p[0]) * q[1] - double(p[1]) * q[0]};
        };
        const auto gb = cofactors(g, b), br = cofactors(b, r), rg = cofactors(r, g);
        const double determinant = r[0] * gb[0] + r[1] * gb[1] + r[2] * gb[2];
        std::array<Color, 3> inverse;
        for (size_t i = 0; i < 3; ++i) {
            inverse[0][i] = float(gb[i] / determinant);
            inverse[1][i] = float(br[i] / determinant);
            inverse[2][i] = float(rg[i] / determinant);
        }
        return inverse;
    }();
    const auto row = [&](const Color& m) { return m[0] * xyz[0] + m[1] * xyz[1] + m[2] * xyz[2]; };
    return {row(kInverse[0]), row(kInverse[1]), row(kInverse[2])};
}

/// Opponent space of the eye's filters (YCxCz): a linear version of CIELAB.
Color to_ycxcz(Rgb c) {
    const Color xyz = to_relative_xyz(c);
    return {116 * xyz[1] - 16, 500 * (xyz[0] - xyz[1]), 200 * (xyz[1] - xyz[2])};
}

Rgb from_ycxcz(const Color& c) {
    const float y = (c[0] + 16) / 116;
    return from_relative_xyz({y + c[1] / 500, y, y - c[2] / 200});
}

/// CIELAB with the chroma scaled by the lightness (Hunt effect).
Color to_hunt_lab(Rgb c) {
    const auto f = [](float t) {
        constexpr float kDelta = 6.0f / 29.0f;
        return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4.0f / 29;
    };
    const Color xyz = to_relative_xyz(c);
    const float lightness = 116 * f(xyz[1]) - 16;
    const float hunt = 0.01f * lightness;
    return {lightness, hunt * 500 * (f(xyz[0]) - f(xyz[1])), hunt * 200 * (f(xyz[1]) - f(xyz[2]))};
}

float hyab(const Color& a, const Color& b) {
    return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]);
}

/// Weights of a filter along one axis; an odd number, the middle one at the pixel itself.
using Kernel = std::vector<float>;

/// A Gaussian of the eye's contrast sensitivity: a sqrt(pi/b) exp(-pi² x² / b), x in degrees.
struct SensitivityGaussian {
    double a, b;
};

/// Kernels along one axis whose outer products, added up, are the 2D filter; its weights sum to 1.
std::vector<Kernel> sensitivity_kernels(std::initializer_list<SensitivityGaussian> gaussians,
                                        float pixels_per_degree) {
    constexpr double kWidest = 0.04, kPiD = 3.14159265358979323846;
    const int radius =
        int(std::ceil(3 * std::sqrt(kWidest / (2 * kPiD * kPiD)) * pixels_per_degree));
    std::vector<Kernel> kernels;
    double sum = 0;
    for (const auto& [a, b] : gaussians) {
        Kernel& kernel = kernels.emplace_back();
        double kernel_sum = 0;
        for (int i = -radius; i <= radius; ++i) {
            const double x = i / double(pixels_per_degree);
            const double g =
                std::sqrt(a * std::sqrt(kPiD / b)) * std::exp(-kPiD * kPiD * x * x / b);
            kernel.push_back(float(g));
            kernel_sum += g;
        }
        sum += kernel_sum * kernel_sum;
    }
    for (Kernel& kernel : kernels)
        for (float& weight : kernel) weight = float(weight / std::sqrt(sum));
    return kernels;
}

struct FeatureKernels {
    Kernel smooth, edge, point;  ///< a Gaussian and its first and second derivative
};

/// Kernels of the feature detectors. The Gaussian sums to 1; each derivative's positive weights sum
/// to 1 and its negative ones to -1.
FeatureKernels feature_kernels(float pixels_per_degree) {
    const double sigma = 0.5 * kFeatureWidthDegrees * pixels_per_degree;
    const int radius = int(std::ceil(3 * sigma));
    FeatureKernels kernels;
    for (int x = -radius; x <= radius; ++x) {
        const double g = std::exp(-x * x / (2 * sigma * sigma));
        kernels.smooth.push_back(float(g));
        kernels.edge.push_back(float(-x * g));
        kernels.point.push_back(float((x * x / (sigma * sigma) - 1) * g));
    }
    for (Kernel* kernel : {&kernels.smooth, &kernels.edge, &kernels.point}) {
        double positive = 0, negative = 0;
        for (float w : *kernel) (w > 0 ? positive : negative) += std::abs(w);
        for (float& w : *kernel) w = float(w / (w > 0 ? positive : negative));
    }
    return kernels;
}

struct Size {
    int width, height;
};

/// Convolves the rows with `horizontal` and the columns with `vertical`.
Plane convolve(const Plane& in, Size size, const Kernel& horizontal, const Kernel& vertical) {
    const auto clamped = [](int i, int count) { return size_t(std::clamp(i, 0, count - 1)); };
    Plane rows(in.size()), out(in.size());
    const size_t width = size_t(size.width);
    parallel_for(size.height, [&](int64_t y) {
        const float* from = &in[size_t(y) * width];
        const int radius = int(horizontal.size() / 2);
        for (int x = 0; x < size.width; ++x) {
            float sum = 0;
            for (int i = -radius; i <= radius; ++i)
                sum += horizontal[size_t(i + radius)] * from[clamped(x + i, size.width)];
            rows[size_t(y) * width + size_t(x)] = sum;
        }
    });
    parallel_for(size.height, [&](int64_t y) {
        float* to = &out[size_t(y) * width];
        const int radius = int(vertical.size() / 2);
        for (int i = -radius; i <= radius; ++i) {
            const float weight = vertical[size_t(i + radius)];
            const float* from = &rows[clamped(int(y) + i, size.height) * width];
            for (size_t x = 0; x < width; ++x) to[x] += weight * from[x];
        }
    });
    return out;
}

/// Perception of one image by an observer.
struct Percept {
    std::vector<Color> lab;  ///< blurred by the eye, Hunt-adjusted
    Plane edges, points;     ///< magnitudes of the detected features
};

Plane magnitude(const Plane& x, const Plane& y) {
    Plane result(x.size());
    for (size_t i = 0; i < x.size(); ++i) result[i] = std::hypot(x[i], y[i]);
    return result;
}

Percept perceive(std::span<const Rgb> image, Size size, float pixels_per_degree) {
    // The constants of Andersson et al. 2020 for the achromatic, red-green and blue-yellow channel.
    const std::vector<Kernel> filters[3] = {
        sensitivity_kernels({{1, 0.0047}}, pixels_per_degree),
        sensitivity_kernels({{1, 0.0053}}, pixels_per_degree),
        sensitivity_kernels({{34.1, 0.04}, {13.5, 0.025}}, pixels_per_degree)};
    Plane planes[3], blurred[3];
    for (Plane& plane : planes) plane.resize(image.size());
    for (size_t i = 0; i < image.size(); ++i) {
        const Color c = to_ycxcz(image[i]);
        for (size_t k = 0; k < 3; ++k) planes[k][i] = c[k];
    }
    for (size_t k = 0; k < 3; ++k) {
        blurred[k].assign(image.size(), 0);
        for (const Kernel& kernel : filters[k]) {
            const Plane part = convolve(planes[k], size, kernel, kernel);
            for (size_t i = 0; i < part.size(); ++i) blurred[k][i] += part[i];
        }
    }
    Percept percept;
    percept.lab.resize(image.size());
    for (size_t i = 0; i < image.size(); ++i) {
        const Rgb c = from_ycxcz({blurred[0][i], blurred[1][i], blurred[2][i]});
        percept.lab[i] = to_hunt_lab({clamp01(c.r), clamp01(c.g), clamp01(c.b)});
    }
    for (float& y : planes[0]) y = (y + 16) / 116;
    const FeatureKernels kernels = feature_kernels(pixels_per_degree);
    percept.edges = magnitude(convolve(planes[0], size, kernels.edge, kernels.smooth),
                              convolve(planes[0], size, kernels.smooth, kernels.edge));
    percept.points = magnitude(convolve(planes[0], size, kernels.point, kernels.smooth),
                               convolve(planes[0], size, kernels.smooth, kernels.point));
    return percept;
}

/// Maps a colour difference to [0, 1]: linear up to a knee, compressed above it.
float remap_color_difference(float difference, float largest) {
    const float d = std::pow(difference, kColorExponent);
    const float knee = kColorKnee * largest;
    const float mapped =
        d < knee ? kColorKneeValue / knee * d
                 : kColorKneeValue + (d - knee) / (largest - knee) * (1 - kColorKneeValue);
    return std::min(mapped, 1.0f);
}

}  // namespace

std::vector<float> flip_error(std::span<const Rgb> image, std::span<const Rgb> reference, int width,
                              int height, float pixels_per_degree) {
    assert(image.size() == reference.size() && image.size() == size_t(width) * size_t(height));
    const Size size{width, height};
    const Percept a = perceive(image, size, pixels_per_degree);
    const Percept b = perceive(reference, size, pixels_per_degree);
    // The largest colour difference in sRGB, according to Andersson et al. 2020: between pure green
    // and pure blue.
    const float largest =
        std::pow(hyab(to_hunt_lab({0, 1, 0}), to_hunt_lab({0, 0, 1})), kColorExponent);
    std::vector<float> error(image.size());
    for (size_t i = 0; i < error.size(); ++i) {
        const float color = remap_color_difference(hyab(a.lab[i], b.lab[i]), largest);
        const float feature_gap =
            std::max(std::abs(a.edges[i] - b.edges[i]), std::abs(a.points[i] - b.points[i]));
        const float feature =
            std::min(std::pow(feature_gap / std::sqrt(2.0f), kFeatureExponent), 1.0f);
        error[i] = std::pow(color, 1 - feature);
    }
    return error;
}

}  // namespace covtrace
