#include "render/layers.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace covtrace {

namespace {

/// Adds channels prefix+suffix and fills them from value(pixel), an array of as many floats.
template <size_t N, typename Value>
void add_layer(Image& image, const std::string& prefix, const std::array<const char*, N>& suffixes,
               const Value& value) {
    const size_t first = image.channels.size();
    for (const char* suffix : suffixes) image.add_channel(prefix + suffix);
    for (size_t i = 0; i < image.pixel_count(); ++i) {
        const std::array<float, N> v = value(i);
        for (size_t c = 0; c < N; ++c) image.channels[first + c].values[i] = v[c];
    }
}

constexpr std::array<const char*, 3> kRgb{"R", "G", "B"};
constexpr std::array<const char*, 3> kXyz{"X", "Y", "Z"};
constexpr std::array<const char*, 3> kSymmetric{"xx", "xy", "yy"};
constexpr std::array<const char*, 15> kFive{"00", "01", "02", "03", "04", "11", "12", "13",
                                            "14", "22", "23", "24", "33", "34", "44"};

std::array<float, 3> array(Rgb c) {
    return {c.r, c.g, c.b};
}
std::array<float, 3> array(Vec3 v) {
    return {v.x, v.y, v.z};
}
std::array<float, 3> array(const covariance::Sym2<float>& s) {
    return {s.xx, s.xy, s.yy};
}

/// The parts of a pixel that the kinds of candidates made, in the order of CandidateKind.
std::array<float, 4> shares_of_kinds(const std::vector<Plane>& shares, size_t pixel) {
    std::array<float, 4> sums{};
    for (size_t c = 0; c < shares.size(); ++c)
        sums[size_t(candidate_kind(CandidateSettings(), c))] += shares[c][pixel];
    return sums;
}

/// Adds what pbrt's "gbuffer" has beyond the other layers.
void add_surfaces(Image& image, const Film& film) {
    const auto& surfaces = film.surfaces;
    add_layer(image, "P.", kXyz, [&](size_t i) { return array(surfaces[i].position); });
    add_layer(image, "Ng.", kXyz,
              [&](size_t i) { return array(normalize(surfaces[i].geometric_normal)); });
    add_layer(image, "uv.", std::array{"X", "Y"}, [&](size_t i) {
        return std::array{surfaces[i].uv.x, surfaces[i].uv.y};
    });
    add_layer(image, "dz.", std::array{"X", "Y"}, [&](size_t i) {
        return std::array{std::abs(surfaces[i].slope.x), std::abs(surfaces[i].slope.y)};
    });
    add_layer(image, "relvariance.", kRgb, [&](size_t i) {
        const Rgb variance = film.pixels[i].variance_of_mean(), mean = film.pixels[i].mean;
        Rgb ratio;
        for (int c = 0; c < 3; ++c) ratio[c] = mean[c] != 0 ? variance[c] / mean[c] : 0.0f;
        return array(ratio);
    });
}

}  // namespace

Image make_layers(const Film& film, PixelBounds display, bool has_holes,
                  const std::optional<CovarianceLayers>& covariance) {
    Image image;
    image.data = film.bounds;
    image.display = display;
    const auto& pixels = film.pixels;
    const auto luminance_variance = [&](size_t i) {
        // The channels of one sample vary together, so that the luminance is of the deviations, not
        // of the variances.
        const Rgb v = pixels[i].variance_of_mean();
        return sqr(luminance({std::sqrt(v.r), std::sqrt(v.g), std::sqrt(v.b)}));
    };
    add_layer(image, "", kRgb, [&](size_t i) {
        return array(covariance ? covariance->gathered.color[i] : pixels[i].mean);
    });
    if (has_holes)
        add_layer(image, "", std::array{"A"}, [&](size_t i) {
            return std::array{film.opacity.empty() ? pixels[i].coverage
                                                   : std::clamp(film.opacity[i], 0.0f, 1.0f)};
        });
    add_layer(image, "raw.", kRgb, [&](size_t i) { return array(pixels[i].mean); });
    if (!film.in_view.empty())
        add_layer(image, "inview.", kRgb, [&](size_t i) { return array(film.in_view[i]); });
    add_layer(image, "albedo.", kRgb, [&](size_t i) { return array(pixels[i].albedo); });
    add_layer(image, "N.", kXyz, [&](size_t i) {
        return array(film.surfaces.empty() ? pixels[i].normal : normalize(film.surfaces[i].normal));
    });
    add_layer(image, "", std::array{"Z"}, [&](size_t i) { return std::array{pixels[i].depth}; });
    if (!film.features.empty()) {
        const auto& features = film.features;
        add_layer(image, "featurealbedo.", kRgb,
                  [&](size_t i) { return array(features[i].albedo); });
        add_layer(image, "featureN.", kXyz, [&](size_t i) { return array(features[i].normal); });
    }
    add_layer(image, "variance.", kRgb,
              [&](size_t i) { return array(pixels[i].variance_of_mean()); });
    if (!film.surfaces.empty()) add_surfaces(image, film);
    add_layer(image, "error.", std::array{"Y"}, [&](size_t i) {
        return std::array{
            std::sqrt(covariance ? covariance->gathered.variance[i] : luminance_variance(i))};
    });
    add_layer(image, "samples.", std::array{"Y"},
              [&](size_t i) { return std::array{float(pixels[i].count)}; });
    if (!covariance) return image;
    add_layer(image, "density.", std::array{"Y"},
              [&](size_t i) { return std::array{covariance->density[i]}; });
    add_layer(image, "filter.", kSymmetric,
              [&](size_t i) { return array(covariance->filter.covariance[i]); });
    add_layer(image, "spectrum.", kSymmetric,
              [&](size_t i) { return array(covariance->prediction.spectrum[i]); });
    add_layer(image, "cov.", kFive,
              [&](size_t i) { return covariance->buffer.covariance[i].values; });
    add_layer(image, "covweight.", std::array{"Y"},
              [&](size_t i) { return std::array{covariance->buffer.weight[i]}; });
    if (covariance->shares)
        add_layer(image, "share.", std::array{"raw", "gaussian", "regression", "denoiser"},
                  [&](size_t i) { return shares_of_kinds(*covariance->shares, i); });
    if (!covariance->scattered) return image;
    add_layer(image, "inviewfilter.", kSymmetric,
              [&](size_t i) { return array(covariance->in_view_filter->covariance[i]); });
    const auto& scattered = *covariance->scattered;
    add_layer(image, "scatteredcov.", kFive,
              [&](size_t i) { return covariance::cast<float>(scattered[i].covariance()).values; });
    add_layer(image, "scatteredcovweight.", std::array{"Y"},
              [&](size_t i) { return std::array{scattered[i].weight}; });
    return image;
}

void request_layers(const LayerSelection& selection, RenderOptions& options) {
    if (names(selection, "inview")) options.emitters_apart = true;
    if (names(selection, "featurealbedo") || names(selection, "featureN")) options.features = true;
    if (names_surfaces(selection)) options.surfaces = true;
}

}  // namespace covtrace
