/// The filters that the spectrum of an image predicts, beside those that the image bears.
///
///     texture_scale [--texels N] IMAGE ...
///
/// At random texels the predicted covariance T gives the Gaussian filter with the covariance
/// (4 pi^2 c^2 T)^-1, c = 2. Its usable scale is the largest factor on the standard deviations up
/// to which all of these filters change the texel's luminance Y by at most 2 % of Y + 0.01. Where
/// the prediction is right the median is near 1; too wide filters show as scales below 0.35. Texels
/// whose wider standard deviation is below half a texel are left out: there is nothing to filter.
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "core/rng.h"
#include "image/raster.h"
#include "texture/image.h"
#include "texture/image_spectrum.h"

namespace {

using namespace covtrace;

constexpr float kWidestStd = 32;  ///< texels; wider predictions are cut off here
constexpr float kLargestScale = 8;
constexpr float kStep = 1.18920712f;  ///< between scales, a quarter of an octave

struct Luminance {
    int width = 0, height = 0;
    std::vector<float> values;
    float at(int x, int y) const {
        const int i = (x % width + width) % width, j = (y % height + height) % height;
        return values[size_t(j) * size_t(width) + size_t(i)];
    }
};

Luminance load(const char* file) {
    const RasterImage raster = read_raster(file);
    const bool is_encoded = raster.is_8bit || raster.is_16bit;
    using Encoding = TextureImage::Encoding;
    const TextureImage image(raster, is_encoded ? Encoding::srgb : Encoding::linear, 1,
                             TextureImage::Wrap::repeat);
    Luminance result{raster.width, raster.height, {}};
    for (size_t i = 0; i < size_t(raster.width) * size_t(raster.height); ++i)
        result.values.push_back(luminance(image.color(i)));
    return result;
}

/// A Gaussian by its standard deviations in texels and the direction of the first.
struct Filter {
    float std1 = 0, std2 = 0;
    Vec2 axis{1, 0};
};

Filter predicted_filter(const SpatialCovariance2& c, const Luminance& image) {
    const float xx = c.ss / sqr(float(image.width)), yy = c.tt / sqr(float(image.height));
    const float xy = c.st / (float(image.width) * float(image.height));
    const float half_trace = 0.5f * (xx + yy), radius = std::hypot(0.5f * (xx - yy), xy);
    const float angle = 0.5f * std::atan2(2 * xy, xx - yy);
    const auto to_std = [](float variance) {
        return std::min(kWidestStd, 1 / (4 * kPi * std::sqrt(std::max(variance, 1e-12f))));
    };
    return {to_std(half_trace + radius),
            to_std(half_trace - radius),
            {std::cos(angle), std::sin(angle)}};
}

float filtered(const Luminance& image, int x, int y, const Filter& f) {
    const int r = int(std::ceil(3.5f * std::max(f.std1, f.std2)));
    double sum = 0, weights = 0;
    for (int j = -r; j <= r; ++j)
        for (int i = -r; i <= r; ++i) {
            const float a = (f.axis.x * float(i) + f.axis.y * float(j)) / f.std1;
            const float b = (f.axis.x * float(j) - f.axis.y * float(i)) / f.std2;
            const float e = a * a + b * b;
            if (e > 12.25f) continue;
            const float w = std::exp(-0.5f * e);
            sum += double(w) * double(image.at(x + i, y + j));
            weights += double(w);
        }
    return float(sum / weights);
}

float usable_scale(const Luminance& image, int x, int y, const Filter& f) {
    const float value = image.at(x, y);
    float usable = 0;
    for (float s = 1 / std::sqrt(128.0f); s < kLargestScale * 1.01f; s *= kStep) {
        if (s > 1 && s * std::max(f.std1, f.std2) > kWidestStd) break;
        const float change = filtered(image, x, y, {s * f.std1, s * f.std2, f.axis}) - value;
        if (std::abs(change) > 0.02f * (value + 0.01f)) break;
        usable = s;
    }
    return usable;
}

void report(const char* file, int texels) {
    const Luminance image = load(file);
    const ImageSpectrum spectrum(image.values, image.width, image.height,
                                 ImageSpectrum::Wrap::repeat);
    Rng rng(7);
    std::vector<float> scales;
    double log_std = 0;
    for (int i = 0; i < texels; ++i) {
        const int x = int(rng.next_float() * float(image.width));
        const int y = int(rng.next_float() * float(image.height));
        const Filter filter = predicted_filter(spectrum.at((float(x) + 0.5f) / float(image.width),
                                                           (float(y) + 0.5f) / float(image.height)),
                                               image);
        log_std += 0.5 * std::log(double(filter.std1) * double(filter.std2));
        if (std::max(filter.std1, filter.std2) > 0.5f)
            scales.push_back(usable_scale(image, x, y, filter));
    }
    std::sort(scales.begin(), scales.end());
    const auto quantile = [&](double p) {
        return scales.empty() ? 0.0 : double(scales[size_t(p * double(scales.size() - 1))]);
    };
    const auto share = [&](auto&& predicate) {
        return 100.0 * double(std::count_if(scales.begin(), scales.end(), predicate)) /
               double(std::max<size_t>(scales.size(), 1));
    };
    const std::string_view path = file;
    std::printf(
        "| %s | %dx%d | %zu | %.2f | %.2f | %.2f | %.2f | %.2f | %.1f %% | %.1f %% | %.2f |\n",
        path.substr(path.rfind('/') + 1).data(), image.width, image.height, scales.size(),
        quantile(0.05), quantile(0.25), quantile(0.5), quantile(0.75), quantile(0.95),
        share([](float s) { return s < 0.35f; }), share([](float s) { return s > 6; }),
        std::exp(log_std / texels));
}

}  // namespace

int main(int argc, char** argv) try {
    int texels = 2000, first = 1;
    if (argc > 2 && std::string_view(argv[1]) == "--texels") {
        texels = std::max(1, std::atoi(argv[2]));
        first = 3;
    }
    if (first >= argc) {
        std::fprintf(stderr, "usage: texture_scale [--texels N] IMAGE ...\n");
        return 2;
    }
    std::printf(
        "| image | texels | examined | p5 | p25 | median | p75 | p95 | < 0.35 | > 6 | std |\n");
    std::printf("|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (int i = first; i < argc; ++i) report(argv[i], texels);
    return 0;
} catch (const covtrace::Error& e) {
    std::fprintf(stderr, "texture_scale: %s\n", e.what());
    return 3;
}
