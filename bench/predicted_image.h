/// A finished render of `--method covariance` with all its layers, taken apart again.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "image/image.h"
#include "planner/covariance_buffer.h"

namespace covtrace {

/// Row by row, image.width() * image.height() entries each.
struct PredictedImage {
    Image image;
    Prediction prediction;        ///< of the smoothed buffer, as the renderer's filters use it
    std::vector<Rgb> mean;        ///< of each pixel's own samples
    std::vector<float> variance;  ///< of the mean's luminance; zero: the tools don't need it
    std::vector<uint32_t> count;
};

/// Throws Error(usage) where a layer is missing, Error(scene) where the file can't be read.
PredictedImage read_predicted_image(const std::filesystem::path& file);

}  // namespace covtrace
