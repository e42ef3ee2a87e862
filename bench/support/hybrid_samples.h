/// The samples of a film of the hybrid method, and reconstructions of them to compare with.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "reconstruction/hybrid.h"
#include "render/film_file.h"

namespace covtrace {

/// The input of reconstruct().
struct HybridSamples {
    PixelBounds region;
    double mean_count;  ///< samples per pixel
    Halves halves;
    std::vector<Covariance2> spectrum;
};

/// Reads a film of `covtrace render --method hybrid --checkpoint FILM`. Throws Error for other
/// films.
HybridSamples read_hybrid_samples(const std::filesystem::path& film);

/// The denoiser that the built program finds. Throws Error(usage) where there is none.
std::shared_ptr<const Denoiser> required_denoiser();

/// Settings of first-order regression alone, as in NFOR (Bitterli et al. 2016): plain windows of
/// two tolerances, explained by filtered features; each pixel takes the better one (or the raw
/// pixel) by the errors that the other half shows.
HybridSettings plain_regression();

}  // namespace covtrace
