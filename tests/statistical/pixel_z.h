/// Per-pixel z-tests of renders: scenes, renders of many seeds, references with their measured
/// variance, and the test of a whole image.
#pragma once

#include <array>
#include <cmath>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "../render/fixtures.h"
#include "chi_square.h"
#include "core/parallel.h"

namespace covtrace {

inline constexpr int kSize = 8, kPixels = kSize * kSize;

struct PixelScene {
    const char* name;
    const char* view;
    const char* world;
    /// Whether alarms are counted; not where pixels are heavy-tailed at 256 samples: alarms come
    /// too often then (docs/decisions/0032).
    bool counts_alarms = true;
};
inline void PrintTo(const PixelScene& s, std::ostream* out) {
    *out << s.name;
}

inline const char* const kFloor = R"(
Material "diffuse" "rgb reflectance" [ 0.6 0.5 0.3 ]
Shape "trianglemesh" "point3 P" [ -9 -1 -9  9 -1 -9  9 -1 9  -9 -1 9 ] "integer indices" [ 0 1 2 0 2 3 ]
)";

inline const PixelScene kScenes[] = {
    {"lamp", R"(Camera "perspective" "float fov" 40)", R"(
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 5 5 4 ]
Translate 1 3 0
Shape "sphere" "float radius" 0.7
AttributeEnd
LightSource "infinite" "rgb L" [ 0.1 0.15 0.2 ]
Material "diffuse" "rgb reflectance" [ 0.7 0.2 0.2 ]
Shape "sphere")"},
    {"glass", R"(Camera "perspective" "float fov" 40)", R"(
LightSource "infinite" "rgb L" [ 0.8 0.8 1 ]
LightSource "distant" "rgb L" [ 1 1 1 ] "point3 from" [ 1 2 -1 ] "point3 to" [ 0 0 0 ]
Material "dielectric" "float eta" 1.5
Shape "sphere")"},
    {"lens_and_motion",
     R"(Camera "perspective" "float fov" 40 "float lensradius" 0.3 "float focaldistance" 4)", R"(
LightSource "infinite" "rgb L" [ 1 0.9 0.8 ]
AttributeBegin
ActiveTransform EndTime
Translate 0.8 0.3 0
ActiveTransform All
Material "diffuse" "rgb reflectance" [ 0.2 0.3 0.8 ]
Shape "sphere" "float radius" 0.8
AttributeEnd)"},
    {"fog", R"(Camera "perspective" "float fov" 40)", R"(
LightSource "infinite" "rgb L" [ 0.5 0.5 0.5 ]
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 3 2.5 2 ]
Translate 0 5 0
Shape "sphere" "float radius" 2
AttributeEnd
AttributeBegin
MakeNamedMedium "m" "string type" "homogeneous" "rgb sigma_a" [ 0.1 0.2 0.4 ] "rgb sigma_s" [ 1 0.8 0.5 ] "float g" 0.4
MediumInterface "m" ""
Material "interface"
Shape "sphere" "float radius" 1.2
AttributeEnd)"},
    {"glossy", R"(Camera "perspective" "float fov" 40)", R"(
LightSource "infinite" "rgb L" [ 0.6 0.7 0.8 ]
AttributeBegin
Translate 0 0 4
Material "conductor" "spectrum eta" "metal-Cu-eta" "spectrum k" "metal-Cu-k" "float roughness" 0.2
Shape "sphere" "float radius" 5
AttributeEnd)"},
    {"room", R"(Camera "perspective" "float fov" 50)", R"(
ReverseOrientation
Material "diffuse" "rgb reflectance" [ 0.6 0.6 0.5 ]
Shape "sphere" "float radius" 6
ReverseOrientation
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 40 36 30 ]
Translate 0.5 3 0
Rotate 90 1 0 0
Shape "disk" "float radius" 0.3
AttributeEnd
Material "conductor" "float roughness" 0.3
Shape "sphere")",
     false},
    {"coat", R"(Camera "perspective" "float fov" 40)", R"(
LightSource "infinite" "rgb L" [ 0.3 0.4 0.5 ]
LightSource "distant" "rgb L" [ 2 2 1.8 ] "point3 from" [ 1 2 -1 ] "point3 to" [ 0 0 0 ]
Texture "checks" "spectrum" "checkerboard" "float uscale" 6 "float vscale" 6
    "rgb tex1" [ 0.1 0.2 0.5 ] "rgb tex2" [ 0.7 0.6 0.2 ]
Material "coateddiffuse" "texture reflectance" "checks" "float roughness" 0.1
Shape "sphere")",
     false},
};

inline std::string scene_text(const std::string& view, const std::string& world, int max_depth) {
    return "Integrator \"volpath\" \"integer maxdepth\" " + std::to_string(max_depth) + R"(
Film "rgb" "integer xresolution" 8 "integer yresolution" 8
PixelFilter "box" "float xradius" 0.5 "float yradius" 0.5
LookAt 0 0.5 -5  0 0 0  0 1 0
)" + view + "\nWorldBegin\n" +
           world;
}

using Pixels = std::vector<double>;

/// The luminances of one render per seed.
inline std::vector<Pixels> render_seeds(const RenderScene& scene, uint64_t first, size_t count,
                                        uint32_t spp) {
    std::vector<Pixels> images(count);
    parallel_for(int64_t(count), [&](int64_t i) {
        PassContext context{
            .scene = scene, .seed = first + uint64_t(i), .max_depth = scene.description.max_depth};
        Film film({0, 0, kSize, kSize});
        const std::vector<uint32_t> counts(kPixels, spp);
        const Monitor monitor;
        radiance_pass(context, film, counts, monitor, [](double) {});
        for (const FilmPixel& p : film.pixels) images[size_t(i)].push_back(luminance(p.mean));
    });
    return images;
}

/// The mean of an image over its pixels and many seeds.
struct ImageMean {
    double value = 0, variance = 0;  ///< variance of the value
};
inline ImageMean image_mean(const RenderScene& scene, size_t renders = 64, uint32_t spp = 64) {
    std::vector<double> means;
    for (const Pixels& image : render_seeds(scene, 11, renders, spp)) {
        double sum = 0;
        for (double p : image) sum += p / kPixels;
        means.push_back(sum);
    }
    ImageMean m;
    const auto n = double(renders);
    for (double v : means) m.value += v / n;
    for (double v : means) m.variance += (v - m.value) * (v - m.value) / (n * (n - 1));
    return m;
}

/// The distribution of one render of a number of samples: mean, variance and skewness of every
/// pixel.
struct Reference {
    Pixels mean = Pixels(kPixels), variance = Pixels(kPixels), skewness = Pixels(kPixels);
    double renders = 0;

    explicit Reference(const std::vector<Pixels>& images) : renders(double(images.size())) {
        for (const Pixels& image : images)
            for (size_t i = 0; i < kPixels; ++i) mean[i] += image[i] / renders;
        Pixels cubes(kPixels);
        for (const Pixels& image : images)
            for (size_t i = 0; i < kPixels; ++i) {
                const double d = image[i] - mean[i];
                variance[i] += d * d / (renders - 1);
                cubes[i] += d * d * d / renders;
            }
        for (size_t i = 0; i < kPixels; ++i)
            if (!is_constant(i)) skewness[i] = cubes[i] / std::pow(variance[i], 1.5);
    }

    /// Whether the pixel is the same in every render, up to rounding.
    bool is_constant(size_t pixel) const {
        return variance[pixel] <= 1e-12 * mean[pixel] * mean[pixel];
    }
    /// Whether the mean of the samples is near enough to a normal distribution for a z-test. It is
    /// not where something bright or dark is met by few of the samples only (the corner of a pixel
    /// behind which a moving ball passes), and such a pixel alone would alarm several times too
    /// often. The bound is five standard errors of the skewness of 120 normal renders.
    bool is_testable(size_t pixel) const {
        constexpr double kMostSkewed = 1.1;
        return !is_constant(pixel) && std::abs(skewness[pixel]) < kMostSkewed;
    }
};

/// Two-sided tail of Student's t with `degrees` degrees of freedom, by Wallace's normal
/// approximation (1959), whose error is below 1 % of the probability at 50 degrees and above.
inline double student_tail(double t, double degrees) {
    const double z =
        (8 * degrees + 1) / (8 * degrees + 3) * std::sqrt(degrees * std::log1p(t * t / degrees));
    return std::erfc(z / std::sqrt(2.0));
}

/// Probability that the most deviating of all pixels deviates so much by chance. `value` is the
/// mean of `renders` renders; the reference's mean is exact where `known`.
inline double image_p(const Pixels& value, double renders, const Reference& reference,
                      const Pixels* known = nullptr) {
    double smallest = 1;
    size_t tested = 0;
    for (size_t i = 0; i < kPixels; ++i) {
        const double expected = known ? (*known)[i] : reference.mean[i];
        const double off = std::abs(value[i] - expected);
        // Pixels that are the same in every render up to rounding can't be tested by their
        // variance.
        if (reference.is_constant(i) && off > 2e-5 * expected + 1e-7) return 0;
        if (!reference.is_testable(i)) continue;
        const double factor = 1 / renders + (known ? 0 : 1 / reference.renders);
        smallest = std::min(smallest, student_tail(off / std::sqrt(reference.variance[i] * factor),
                                                   reference.renders - 1));
        ++tested;
    }
    return tested > 0 ? 1 - std::pow(1 - smallest, double(tested)) : 1;
}

inline Pixels mean_of(const std::vector<Pixels>& images) {
    return Reference(images).mean;
}

/// Bounds that a binomial count of n trials leaves with probability `outside` / 2 on either side.
inline std::pair<int, int> binomial_bounds(int n, double p, double outside) {
    double cumulated = 0;
    int lo = -1, hi = n;
    for (int k = 0; k <= n; ++k) {
        const double term =
            std::exp(std::lgamma(n + 1) - std::lgamma(k + 1) - std::lgamma(n - k + 1) +
                     k * std::log(p) + (n - k) * std::log1p(-p));
        cumulated += term;
        if (lo < 0 && cumulated > outside / 2) lo = k;
        if (cumulated >= 1 - outside / 2) {
            hi = k;
            break;
        }
    }
    return {lo, hi};
}

}  // namespace covtrace
