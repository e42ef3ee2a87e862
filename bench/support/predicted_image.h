/// A finished render of `--method covariance` with all its layers, taken apart again.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "image/image.h"
#include "prediction/covariance_buffer.h"
#include "reconstruction/filter_field.h"

namespace covtrace {

/// The parts of the render, row by row, image.width() * image.height() entries each.
struct PredictedImage {
    Image image;
    Prediction prediction;  ///< of scattered light, smoothed, as the renderer's filters use it
    std::vector<Rgb> scattered,
        in_view;  ///< means of each pixel's own samples, which they add up to
    /// Filters as the renderer applied them; those of emitters in view are the narrowest where
    /// there is no emitter.
    FilterField filters, in_view_filters;
    std::vector<bool> shows_emitter;  ///< some covariance path of the pixel met one in view
    std::vector<uint32_t> count;
};

/// The layers that the image must be rendered with.
constexpr const char* kPredictedLayers = "all,inview,inviewfilter,scatteredcov,scatteredcovweight";

/// Reads the image. Throws Error(usage) where a layer is missing, Error(scene) where the file can't
/// be read.
PredictedImage read_predicted_image(const std::filesystem::path& file);

}  // namespace covtrace
