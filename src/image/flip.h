/// FLIP: how visible the difference between two images is when they alternate on a screen.
///
/// Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild: "FLIP: A Difference Evaluator
/// for Alternating Images", HPG 2020. Both images are blurred as the eye does it at the given
/// viewing distance and compared in CIELAB (colour difference), edges and points are detected and
/// compared (feature difference); the error is colour^(1 - feature), in [0, 1].
#pragma once

#include <span>
#include <vector>

#include "core/vec.h"

namespace covtrace {

/// FLIP error of every pixel, row by row. `image`, `reference`: width * height linear colours of a
/// display in [0, 1]; pixels beyond the border repeat the last one. Symmetric in the images.
/// `pixels_per_degree`: 67 for a 0.7 m wide 4K screen seen from 0.7 m.
std::vector<float> flip_error(std::span<const Rgb> image, std::span<const Rgb> reference, int width,
                              int height, float pixels_per_degree = 67);

}  // namespace covtrace
