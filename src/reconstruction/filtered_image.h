/// An image through filters.
#pragma once

#include <vector>

#include "core/vec.h"

namespace covtrace {

/// One entry per pixel.
struct FilteredImage {
    std::vector<Rgb> color;
    /// Variance of the luminance, by propagation, without the filters' bias; infinite where a
    /// filter found nothing.
    std::vector<float> variance;
    std::vector<float> own_weight;  ///< the part of the pixel's own mean in its filtered one
};

}  // namespace covtrace
