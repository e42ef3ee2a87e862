#include "render/render_memory.h"

#include <algorithm>

#include "prediction/packed_covariance.h"
#include "render/overrides.h"

namespace covtrace {

namespace {

/// Bytes per pixel of layers and reconstruction, as `bench/speed/film_cost memory` measures them.
size_t image_bytes(Method method) {
    return method == Method::uniform ? 68 : method == Method::covariance ? 410 : 488;
}

/// Bytes per pixel of the layers that only some images have, measured likewise: of surfaces P, Ng,
/// uv, dz and relvariance, of features and of emitters in view their colours.
size_t further_layers_bytes(Method method, FilmParts parts) {
    constexpr size_t kSurfaces = 13 * sizeof(float), kFeatures = 6 * sizeof(float),
                     kInView = 3 * sizeof(float);
    const size_t surfaces = parts.surfaces ? kSurfaces : 0;
    if (method == Method::covariance) return surfaces;
    // The features of the halves of `hybrid` are there while their mean is made.
    const size_t features = !parts.features ? 0 : kFeatures * (method == Method::hybrid ? 2 : 1);
    return surfaces + features + (method == Method::uniform && parts.in_view ? kInView : 0);
}

/// Bytes of the reconstruction's planes beyond the image, where they go on by the reach of its
/// filters and by a vector of eight. Measured on images of one row and of one column, where borders
/// are most of the memory.
size_t border_bytes(Method method, const PixelBounds& region) {
    if (method != Method::hybrid) return 0;
    constexpr size_t kReach = 2 * 13, kBytes = 160;
    const size_t width = size_t(region.width()), height = size_t(region.height());
    const size_t all = (width + kReach + 8) * (height + kReach);
    return kBytes * (all - width * height);
}

/// Bytes of a denoiser beyond image_bytes: while it works, the other candidates are not there yet,
/// and of its own memory only its candidate stays.
size_t denoiser_bytes(const Denoiser& denoiser, size_t pixels) {
    constexpr size_t kMeanwhile = 310, kCandidate = 36;
    const size_t peak = denoiser.memory(pixels) + kMeanwhile * pixels,
                 otherwise = image_bytes(Method::hybrid) * pixels;
    return std::max(peak, otherwise + kCandidate * pixels) - otherwise;
}

}  // namespace

size_t film_bytes_per_pixel(Method method, FilmParts parts) {
    constexpr size_t kPlan = sizeof(uint32_t), kDensity = sizeof(float),
                     kCovariance = sizeof(PackedCovariance),
                     kFeatureRecords =
                         sizeof(PathFeatures) + sizeof(FeatureSquares) + sizeof(uint32_t);
    const size_t further =
        (parts.surfaces ? sizeof(FirstSurface) : 0) + (parts.opacity ? sizeof(float) : 0);
    switch (method) {
        case Method::uniform:
            return sizeof(FilmPixel) + (parts.in_view ? sizeof(Rgb) : 0) +
                   (parts.features ? kFeatureRecords : 0) + further + kPlan;
        case Method::covariance:
            return sizeof(FilmPixel) + sizeof(Rgb) + further + kPlan + kDensity + 2 * kCovariance;
        case Method::hybrid:
            break;
    }
    const size_t half = sizeof(FilmPixel) + kFeatureRecords + further + kPlan;
    // Both parts of the light are kept up to the end of the pilot; then their sum, and densities.
    return 2 * half + std::max(2 * kCovariance, kCovariance + kDensity);
}

std::map<std::string, size_t> render_memory(const FilmDescription& film,
                                            const RenderOptions& options, bool keeps_opacity) {
    const FilmParts parts{options.emitters_apart, options.features,
                          kept_surfaces(film, options) != FilmDescription::Surfaces::none,
                          keeps_opacity};
    const size_t kept = film_bytes_per_pixel(options.method, parts),
                 layers = image_bytes(options.method) + further_layers_bytes(options.method, parts);
    const PixelBounds region = render_region(film);
    const size_t pixels = size_t(region.width()) * size_t(region.height());
    std::map<std::string, size_t> bytes{
        {"film", kept * pixels}, {"image", layers * pixels + border_bytes(options.method, region)}};
    if (options.method == Method::hybrid && options.denoiser)
        bytes["denoiser"] = denoiser_bytes(*options.denoiser, pixels);
    return bytes;
}

}  // namespace covtrace
