/// Image layers, made of the film and of what was computed from it.
#pragma once

#include <optional>
#include <vector>

#include "image/image.h"
#include "image/layer_selection.h"
#include "prediction/covariance_buffer.h"
#include "reconstruction/candidates.h"
#include "reconstruction/filter_field.h"
#include "reconstruction/filtered_image.h"
#include "render/film.h"
#include "render/options.h"

namespace covtrace {

/// Data of the covariance method beyond the film, for its layers.
struct CovarianceLayers {
    const CovarianceBuffer& buffer;  ///< of all light
    const Prediction& prediction;    ///< of all light, before smoothing and clamps
    std::vector<float> density;      ///< samples per pixel that the plan asked for
    const FilterField& filter;       ///< as predicted for scattered light
    const FilteredImage& gathered;   ///< the delivered image
    /// Covariances of scattered light alone, and the filters as applied to the emitters; null where
    /// no emitters are in view.
    const std::vector<PackedCovariance>* scattered = nullptr;
    const FilterField* in_view_filter = nullptr;
    /// Shares of the candidates in the delivered image; null where it is no mixture.
    const std::vector<Plane>* shares = nullptr;
};

/// Makes the layers. Root R G B (A where `has_holes`): the gathered image, or the raw film without
/// `covariance`; then raw, inview where the film knows it, albedo, N, Z, variance, what the film
/// knows of the first surfaces, error, samples, and the layers of `covariance`
/// (docs/reference/layers.md).
Image make_layers(const Film& film, PixelBounds display, bool has_holes,
                  const std::optional<CovarianceLayers>& covariance);

/// Makes a render collect what the selection's names need, beside what it collects already.
void request_layers(const LayerSelection& selection, RenderOptions& options);

}  // namespace covtrace
