/// The film and what was computed from it as named image layers.
#pragma once

#include <optional>

#include "image/image.h"
#include "planner/covariance_buffer.h"
#include "reconstruction/gather.h"
#include "render/film.h"

namespace covtrace {

/// What the covariance method knows beyond the film, for its layers.
struct CovarianceLayers {
    const CovarianceBuffer& buffer;
    const Prediction& prediction;   ///< before smoothing and clamps
    std::vector<float> density;     ///< samples per pixel that the plan asked for
    const FilterField& filter;      ///< as applied
    const GatheredImage& gathered;  ///< the delivered image
};

/// Root R G B (A where `has_holes`): the gathered image, or the raw film without `covariance`;
/// then raw, albedo, N, Z, variance, error, samples, and the layers of `covariance`.
Image make_layers(const Film& film, PixelBounds display, bool has_holes,
                  const std::optional<CovarianceLayers>& covariance);

}  // namespace covtrace
